// SPDX-License-Identifier: Apache-2.0
#include "image/decode.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "image/oiio.h"

enum {
    MEBIBYTE = 1 << 20,
    LONGEST_TEXT = 1 << 20, // of an attribute
    MOST_ATTRIBUTES = 4096,
};

// AddressSanitizer maps its shadow memory far beyond any limit, and more as it goes.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNDER_ASAN true
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define UNDER_ASAN true
#elif !defined(UNDER_ASAN)
#define UNDER_ASAN false
#endif

// What the child sends first; names, attributes and pixels follow, or the message.
struct packet {
    int32_t ok, unsupported, absent, width, height, channels, attributes, bits, srgb;
    int32_t full_width, full_height, crop_x, crop_y;
};

struct attribute_packet {
    char name[IMAGE_NAME_SIZE];
    double number;
    int32_t text_size; // -1: a number
};

uint64_t decoder_pixel_limit(uint64_t file_size) {
    return 768 * (uint64_t)MEBIBYTE + 64 * file_size;
}

// Of processor time, so that a busy machine refuses nothing that an idle one reads.
static double decoder_seconds(uint64_t file_size) {
    return 8 + (double)file_size / (4 * MEBIBYTE);
}

// Of time on the clock, for a decoder that waits for ever.
static double decoder_patience(uint64_t file_size) {
    return 8 * decoder_seconds(file_size);
}

bool decoder_fail(struct decoder_input *in, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(in->message, sizeof in->message, format, args);
    va_end(args);
    return false;
}

bool decoder_init_image(struct decoder_input *in, struct image *im, int64_t width, int64_t height,
                        int64_t channels) {
    const uint64_t limit = decoder_pixel_limit(in->file_size);
    if (width < 1 || height < 1 || channels < 1 || width > INT32_MAX || height > INT32_MAX ||
        channels > 4096)
        return decoder_fail(in, "claims a size of %lld x %lld pixels and %lld channels",
                            (long long)width, (long long)height, (long long)channels);
    if ((double)width * (double)height * (double)channels * sizeof(float) > (double)limit)
        return decoder_fail(in,
                            "claims %lld x %lld pixels and %lld channels; a file of %llu bytes may "
                            "take at most %llu MiB of memory",
                            (long long)width, (long long)height, (long long)channels,
                            (unsigned long long)in->file_size,
                            (unsigned long long)(limit / MEBIBYTE));
    return image_init(im, (int)width, (int)height, (int)channels);
}

static bool write_all(int fd, const void *data, size_t size) {
    const char *p = data;
    while (size > 0) {
        const ssize_t n = write(fd, p, size);
        if (n <= 0 && errno != EINTR)
            return false;
        if (n > 0)
            p += n, size -= (size_t)n;
    }
    return true;
}

static void send_image(int fd, const struct image *im) {
    const struct packet head = {
        1, 0, 0, im->width, im->height, im->channels, im->attribute_count, im->bits, im->srgb_encoded,
        im->full_width, im->full_height, im->crop_x, im->crop_y,
    };
    bool good = write_all(fd, &head, sizeof head) &&
                write_all(fd, im->channel_names, (size_t)im->channels * sizeof *im->channel_names);
    for (int i = 0; i < im->attribute_count && good; i++) {
        const struct image_attribute *a = &im->attributes[i];
        struct attribute_packet p = {.number = a->number,
                                     .text_size = a->text ? (int32_t)strlen(a->text) : -1};
        memcpy(p.name, a->name, sizeof p.name);
        good = write_all(fd, &p, sizeof p) && (!a->text || write_all(fd, a->text, strlen(a->text)));
    }
    if (good)
        write_all(fd, im->pixels, (size_t)im->width * im->height * im->channels * sizeof(float));
}

static size_t address_space(void) {
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f && fscanf(f, "%lu", &pages) != 1)
        pages = 0;
    if (f)
        fclose(f);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

static void limit_resources(uint64_t file_size) {
    const rlim_t seconds = (rlim_t)decoder_seconds(file_size);
    setrlimit(RLIMIT_CPU, &(struct rlimit){seconds, seconds + 1});
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    const size_t mapped = address_space();
    const rlim_t memory = mapped + decoder_pixel_limit(file_size) + 256 * MEBIBYTE;
    if (mapped > 0 && !UNDER_ASAN)
        setrlimit(RLIMIT_AS, &(struct rlimit){memory, memory});
}

// The child: never returns, runs no exit handlers, prints nothing (libpng would).
static void child_main(int fd, struct decoder_input *in, image_decoder decode) {
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    const int null = open("/dev/null", O_RDWR);
    if (null >= 0) {
        dup2(null, STDOUT_FILENO);
        dup2(null, STDERR_FILENO);
    }
    limit_resources(in->file_size);
    struct image im = {0};
    if (decode(in, &im)) {
        send_image(fd, &im);
    } else {
        const struct packet head = {.unsupported = in->unsupported, .absent = in->absent};
        if (write_all(fd, &head, sizeof head))
            write_all(fd, in->message, sizeof in->message);
    }
    _exit(0);
}

// Reads exactly size bytes before the deadline; false: end of data or time.
static bool read_all(int fd, void *data, size_t size, double deadline) {
    char *p = data;
    while (size > 0) {
        const double left = deadline - time_seconds();
        struct pollfd ready = {.fd = fd, .events = POLLIN};
        if (left <= 0 || (poll(&ready, 1, (int)(left * 1000) + 1) < 0 && errno != EINTR))
            return false;
        if (!ready.revents)
            continue;
        const ssize_t n = read(fd, p, size);
        if (n == 0 || (n < 0 && errno != EINTR))
            return false;
        if (n > 0)
            p += n, size -= (size_t)n;
    }
    return true;
}

static bool receive_attribute(int fd, struct image *im, double deadline) {
    struct attribute_packet p;
    if (!read_all(fd, &p, sizeof p, deadline) || p.text_size > LONGEST_TEXT)
        return false;
    p.name[sizeof p.name - 1] = '\0';
    if (p.text_size < 0) {
        image_set_number(im, p.name, p.number);
        return true;
    }
    char *text = mem_array((size_t)p.text_size + 1, 1);
    const bool good = read_all(fd, text, (size_t)p.text_size, deadline);
    if (good)
        image_set_text(im, p.name, text);
    mem_free(text);
    return good;
}

// Messages quote the file's own names: bytes that would spoil a line of text become '?'.
static void clean(char *message) {
    size_t n = strlen(message);
    while (n > 0 && message[n - 1] == '\n')
        message[--n] = '\0';
    for (char *c = message; *c; c++)
        if (*c == '\n')
            *c = ' ';
        else if ((unsigned char)*c < 32 || (unsigned char)*c > 126)
            *c = '?';
}

// false: the child died, ran out of time, or refused (then in->message says why).
static bool receive_image(int fd, struct decoder_input *in, struct image *im, double deadline) {
    struct packet head;
    if (!read_all(fd, &head, sizeof head, deadline))
        return false;
    if (!head.ok) {
        in->unsupported = head.unsupported;
        in->absent = head.absent;
        read_all(fd, in->message, sizeof in->message, deadline);
        in->message[sizeof in->message - 1] = '\0';
        clean(in->message);
        return false;
    }
    if (head.attributes < 0 || head.attributes > MOST_ATTRIBUTES ||
        !decoder_init_image(in, im, head.width, head.height, head.channels))
        return false;
    im->bits = head.bits;
    im->srgb_encoded = head.srgb;
    im->full_width = head.full_width;
    im->full_height = head.full_height;
    im->crop_x = head.crop_x;
    im->crop_y = head.crop_y;
    const size_t names = (size_t)im->channels * sizeof *im->channel_names;
    bool good = read_all(fd, im->channel_names, names, deadline);
    for (int i = 0; i < head.attributes && good; i++)
        good = receive_attribute(fd, im, deadline);
    const size_t pixels = (size_t)im->width * im->height * im->channels * sizeof(float);
    return good && read_all(fd, im->pixels, pixels, deadline);
}

// Says why there is no picture, given how the child ended.
static void report(const struct decoder_input *in, int status, bool late) {
    if (in->message[0] && in->absent)
        log_error("%s: %s", in->path, in->message);
    else if (in->message[0])
        log_error("%s: cannot be read: %s", in->path, in->message);
    else if (late || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
        log_error("%s: cannot be read: decoding took longer than %.0f s", in->path,
                  decoder_seconds(in->file_size));
    else if (WIFSIGNALED(status))
        log_error("%s: cannot be read: it is damaged, or needs more memory than a file of its size "
                  "may take (the decoder died of signal %d)",
                  in->path, WTERMSIG(status));
    else
        log_error("%s: cannot be read: it is damaged (the decoder ended early)", in->path);
}

static bool run_child(struct decoder_input *in, image_decoder decode, struct image *im) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        log_error("%s: cannot be read: no pipe: %s", in->path, strerror(errno));
        return false;
    }
    const double deadline = time_seconds() + decoder_patience(in->file_size);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        child_main(ends[1], in, decode);
    }
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        log_error("%s: cannot be read: no child process: %s", in->path, strerror(errno));
        return false;
    }
    const bool good = receive_image(ends[0], in, im, deadline);
    const bool late = time_seconds() >= deadline;
    close(ends[0]);
    if (!good && late)
        kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    if (!good && !in->unsupported)
        report(in, status, late);
    if (!good)
        image_finish(im);
    return good;
}

static bool find_file(struct decoder_input *in) {
    struct stat st;
    if (stat(in->path, &st) != 0 || access(in->path, R_OK) != 0) {
        log_error("%s: cannot be read: %s", in->path, strerror(errno));
        return false;
    }
    if (!S_ISREG(st.st_mode)) {
        log_error("%s: is not a regular file", in->path);
        return false;
    }
    in->file_size = (uint64_t)st.st_size;
    return true;
}

bool image_decode_part_in_child(const char *path, const char *part, image_decoder decode,
                                struct image *im) {
    struct decoder_input in = {.path = path, .part = part};
    return find_file(&in) && run_child(&in, decode, im);
}

bool image_decode_bytes_in_child(const char *name, const void *data, size_t size,
                                 image_decoder decode, struct image *im) {
    struct decoder_input in = {.path = name, .data = data, .file_size = size};
    return run_child(&in, decode, im);
}

bool image_decode_in_child(const char *path, image_decoder decode, image_decoder fallback,
                           struct image *im) {
    struct decoder_input in = {.path = path};
    if (!find_file(&in))
        return false;
    if (run_child(&in, decode, im))
        return true;
    if (!in.unsupported)
        return false;
    if (fallback && oiio_load()) {
        in.unsupported = false;
        in.message[0] = '\0';
        return run_child(&in, fallback, im);
    }
    report(&in, 0, false);
    return false;
}
