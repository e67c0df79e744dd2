// SPDX-License-Identifier: Apache-2.0
// Odd and hostile pictures of the shared data: what is sound is read, everything else is refused
// with one line that names the file, by a decoder that lives to say so. No file may take more than
// 10 s of processor time or 1 GiB (memory_limit.h).
#include <dirent.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "capture.h"
#include "check.h"
#include "decoder_death.h"
#include "image/image.h"
#include "image/oiio.h"
#include "memory_limit.h"

enum verdict { READ, REFUSE, EITHER };

static const struct {
    const char *name;
    int least; // files in it
    enum verdict verdict;
} folders[] = {
    {"hostile/openexr-damaged", 177, REFUSE},
    {"hostile/pngsuite/corrupt", 14, REFUSE},
    {"hostile/pngsuite/primary", 77, READ},
    {"hostile/pngsuite/primary_check", 77, READ},
    {"hostile/pngsuite/16bit", 23, READ},
    {"hostile/pngsuite/iphone", 7, REFUSE}, // Apple's own format, no valid PNG
    {"hostile/pngsuite/unused", 60, EITHER},
    {"env/hdr-format-tests", 4, EITHER},
    {"env/openexr-images", 10, EITHER},
    {"env/blender-studiolights", 8, EITHER}, // DWA-compressed
};

static double processor_seconds(void) {
    struct rusage own, children;
    getrusage(RUSAGE_SELF, &own);
    getrusage(RUSAGE_CHILDREN, &children);
    return (double)(own.ru_utime.tv_sec + children.ru_utime.tv_sec) +
           1e-6 * (double)(own.ru_utime.tv_usec + children.ru_utime.tv_usec);
}

static int count_lines(const char *text) {
    int n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

static void check_file(const char *path, enum verdict verdict) {
    struct image im;
    const double start = processor_seconds();
    capture_begin();
    const bool ok = image_read(path, &im);
    capture_end();
    const double seconds = processor_seconds() - start;
    const bool right = (verdict == EITHER || ok == (verdict == READ)) && seconds < 10 &&
                       (ok || (captured_has(path) && count_lines(captured) == 1 &&
                              !decoder_died(captured)));
    CHECK(right);
    if (!right)
        printf("%s: %s after %.1f s: %s\n", path, ok ? "read" : "refused", seconds, captured);
    image_finish(&im);
}

static void check_folder(const char *name, int least, enum verdict verdict) {
    char folder[2048], path[4096];
    int files = 0;
    snprintf(folder, sizeof folder, "%s/%s", getenv("RELUME_SHARED_DATA"), name);
    DIR *d = opendir(folder);
    CHECK(d);
    for (struct dirent *e = d ? readdir(d) : NULL; e; e = readdir(d)) {
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        const bool document = strstr(e->d_name, "LICENSE") || strstr(e->d_name, ".rst") ||
                              strstr(e->d_name, ".txt") || strstr(e->d_name, ".md");
        if (e->d_name[0] == '.' || document)
            continue;
        files++;
        check_file(path, verdict);
    }
    if (d)
        closedir(d);
    CHECK(files >= least);
    printf("%s: %d pictures\n", name, files);
}

int main(void) {
    struct rusage children;
    if (!getenv("RELUME_SHARED_DATA"))
        return 77;
    oiio_load(); // its libraries are no part of what a file takes
    memory_limit();
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        check_folder(folders[i].name, folders[i].least, folders[i].verdict);
    getrusage(RUSAGE_CHILDREN, &children);
    printf("largest child: %ld MiB\n", children.ru_maxrss / 1024);
    CHECK(children.ru_maxrss < MEMORY_LIMIT_MEBIBYTES * 1024);
    return check_result();
}
