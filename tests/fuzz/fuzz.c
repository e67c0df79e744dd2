// SPDX-License-Identifier: Apache-2.0
#include "fuzz.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "decoder_death.h"
#include "image/oiio.h"
#include "memory_limit.h"
#include "mutate.h"

enum { BATCH = 200, SECONDS = 10, WALL_SECONDS = 120 };

enum outcome { PENDING, READ, REFUSED, GOOD_REFUSED, SILENT, CRASHED, HUNG };
static const char *const outcome_names[] = {
    "pending", "read", "refused", "good and yet refused", "refused without a word", "crashed", "hung"};

struct fuzz {
    const char *name;
    fuzz_reader read;
    int count;
    uint64_t seed;
    const char **files;
    int file_count, good_count; // the good ones stand first
    int suspect; // the case that hung once; -1: none
    unsigned char *outcomes; // shared with the children
    char directory[64], message_path[128], meshes[128]; // meshes: a link, or empty
};

// The first cases are the good files as they are.
static bool is_good(const struct fuzz *f, int i) {
    return i < f->good_count;
}

static struct mutant make_case(const struct fuzz *f, int i) {
    struct rng rng = {hash_u64(f->seed) ^ hash_u64((uint64_t)i + 1)};
    size_t size;
    const char *path = f->files[i % f->file_count];
    char *data = file_read(path, 0, &size);
    if (!data)
        exit(2);
    if (is_good(f, i))
        return (struct mutant){(unsigned char *)data, size};
    const struct mutant m = mutate((const unsigned char *)data, size, &rng);
    mem_free(data);
    return m;
}

static void case_path(const struct fuzz *f, int i, char *path, size_t n) {
    char extension[16];
    file_extension(f->files[i % f->file_count], extension, sizeof extension);
    snprintf(path, n, "%s/%s-%llu-%d.%s", f->directory, f->name, (unsigned long long)f->seed, i,
             extension);
}

static void write_case(const struct fuzz *f, int i, const char *path) {
    struct mutant m = make_case(f, i);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(m.data, 1, m.size, file) != m.size || fclose(file) != 0) {
        perror(path);
        exit(2);
    }
    mem_free(m.data);
}

// What the messages of the case, which begin at byte `from` of the file, make of its refusal; those
// that make it a fault are shown.
static enum outcome judge_refusal(const struct fuzz *f, int i, long from, const char *path) {
    FILE *file = fopen(f->message_path, "rb");
    static char text[1 << 16];
    if (!file || fseek(file, from, SEEK_SET) != 0)
        exit(2);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    const bool named = strstr(text, path) != NULL, good = is_good(f, i);
    if (good)
        printf("%s: is %s: %s\n", f->files[i], outcome_names[GOOD_REFUSED], text);
    else if (decoder_died(text))
        printf("%s: its decoder crashed: %s\n", path, text);
    else if (!named)
        printf("%s: refused without a word, or with one that does not name it: %s\n", path, text);
    return good ? GOOD_REFUSED : decoder_died(text) ? CRASHED : named ? REFUSED : SILENT;
}

// 10 seconds of processor time; for the case that a process sleeps, or its child hangs, also wall
// time, which is generous because a machine may be busy with other things.
static void set_timer(int seconds, unsigned wall_seconds) {
    const struct itimerval t = {.it_value = {.tv_sec = seconds}};
    setitimer(ITIMER_PROF, &t, NULL);
    alarm(wall_seconds);
}

static void run_case(const struct fuzz *f, int i) {
    char path[256];
    case_path(f, i, path, sizeof path);
    write_case(f, i, path);
    fflush(stderr);
    const long from = (long)lseek(2, 0, SEEK_END);
    fprintf(stderr, "case %d\n", i);
    set_timer(SECONDS, WALL_SECONDS);
    const bool good = f->read(path);
    set_timer(0, 0);
    fflush(stderr);
    const long at = from + snprintf(NULL, 0, "case %d\n", i);
    f->outcomes[i] = good ? READ : judge_refusal(f, i, at, path);
    if (f->outcomes[i] == READ || f->outcomes[i] == REFUSED)
        remove(path);
}

static _Noreturn void run_batch(const struct fuzz *f, int first, int end) {
    const int fd = open(f->message_path, O_RDWR | O_CREAT | O_TRUNC | O_APPEND, 0666);
    if (fd < 0 || dup2(fd, 2) < 0)
        exit(2);
    oiio_load(); // its libraries are no part of what a file takes
    memory_limit();
    const struct rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    for (int i = first; i < end; i++)
        run_case(f, i);
    exit(0);
}

// Keeps what the child wrote beside the file of the case it died of.
static void keep_messages(const struct fuzz *f, int i) {
    char path[256], to[300];
    case_path(f, i, path, sizeof path);
    snprintf(to, sizeof to, "%s.txt", path);
    rename(f->message_path, to);
    printf("%s: %s, see %s.txt\n", path, outcome_names[f->outcomes[i]], path);
}

// Runs cases from `first` on in one child; returns the first one that is still to be done.
static int fork_batch(struct fuzz *f, int first, int end) {
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        run_batch(f, first, end);
    int status;
    if (child < 0 || waitpid(child, &status, 0) != child) {
        perror("fork");
        exit(2);
    }
    int i = first;
    while (i < end && f->outcomes[i] != PENDING)
        i++;
    if (i == end)
        return end;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 2)
        exit(2);
    const int death = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const bool hung = death == SIGALRM || death == SIGPROF;
    if (hung && i != f->suspect) { // the machine may have stopped all that runs: once more
        f->suspect = i;
        return i;
    }
    f->outcomes[i] = hung ? HUNG : CRASHED;
    keep_messages(f, i);
    return i + 1;
}

static void add_file(struct fuzz *f, const char *argument) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    char *path = mem_array(4096, 1);
    if (strncmp(argument, "@/", 2) != 0)
        snprintf(path, 4096, "%s", argument);
    else if (shared)
        snprintf(path, 4096, "%s%s", shared, argument + 1);
    else
        return mem_free(path);
    f->files[f->file_count++] = path;
}

static void parse(struct fuzz *f, int argc, char **argv) {
    const char *full = getenv("RELUME_TEST_FULL");
    int long_count = 0;
    f->count = 200;
    f->good_count = -1;
    f->files = mem_array((size_t)argc, sizeof *f->files);
    for (int i = 1; i < argc; i++) {
        const bool value = i + 1 < argc;
        if (strcmp(argv[i], "--count") == 0 && value)
            f->count = atoi(argv[++i]);
        else if (strcmp(argv[i], "--full") == 0 && value)
            long_count = atoi(argv[++i]);
        else if (strcmp(argv[i], "--seed") == 0 && value)
            f->seed = strtoull(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--refused") == 0)
            f->good_count = f->file_count;
        else
            add_file(f, argv[i]);
    }
    if (f->good_count < 0)
        f->good_count = f->file_count;
    if (full && *full && long_count)
        f->count = long_count;
}

// A scene names the meshes that lie beside it: its copies must find them.
static void link_meshes(struct fuzz *f) {
    for (int i = 0; i < f->file_count; i++) {
        const char *slash = strrchr(f->files[i], '/');
        char near[4096];
        snprintf(near, sizeof near, "%.*s/meshes", slash ? (int)(slash - f->files[i]) : 1,
                 slash ? f->files[i] : ".");
        char *meshes = realpath(near, NULL);
        if (!meshes)
            continue;
        snprintf(f->meshes, sizeof f->meshes, "%s/meshes", f->directory);
        if (symlink(meshes, f->meshes) != 0) { // also if two of the files have some
            perror(f->meshes);
            exit(2);
        }
        free(meshes);
    }
}

static int report(const struct fuzz *f) {
    int counts[HUNG + 1] = {0};
    for (int i = 0; i < f->count; i++)
        counts[f->outcomes[i]]++;
    printf("%s: %d copies of %d files, seed %llu:", f->name, f->count, f->file_count,
           (unsigned long long)f->seed);
    for (int k = READ; k <= HUNG; k++)
        printf(" %d %s%s", counts[k], outcome_names[k], k < HUNG ? "," : "\n");
    return counts[GOOD_REFUSED] + counts[SILENT] + counts[CRASHED] + counts[HUNG] + counts[PENDING] > 0;
}

int fuzz_main(int argc, char **argv, const char *name, fuzz_reader read) {
    struct fuzz f = {.name = name, .read = read, .suspect = -1};
    parse(&f, argc, argv);
    if (f.file_count == 0) {
        printf("%s: no file to start from\n", name);
        mem_free(f.files);
        return 77;
    }
    f.outcomes = mmap(NULL, (size_t)f.count + 1, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS,
                      -1, 0);
    snprintf(f.directory, sizeof f.directory, "fuzz-XXXXXX");
    if (f.outcomes == MAP_FAILED || !mkdtemp(f.directory)) {
        perror("fuzz");
        return 2;
    }
    snprintf(f.message_path, sizeof f.message_path, "%s/messages", f.directory);
    link_meshes(&f);
    for (int i = 0; i < f.count;)
        i = fork_batch(&f, i, i + BATCH < f.count ? i + BATCH : f.count);
    const int status = report(&f);
    remove(f.message_path);
    if (status == 0 && *f.meshes)
        remove(f.meshes);
    rmdir(f.directory); // stays when something is kept in it
    for (int i = 0; i < f.file_count; i++)
        mem_free((void *)(uintptr_t)f.files[i]);
    mem_free(f.files);
    munmap(f.outcomes, (size_t)f.count + 1);
    return status;
}
