// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/log.h"
#include "base/mem.h"

char *file_read(const char *path, size_t limit, size_t *size) {
    char *data = NULL;
    FILE *f = fopen(path, "rb");
    struct stat st;
    if (!f || fstat(fileno(f), &st) != 0) {
        log_error("%s: cannot be read: %s", path, strerror(errno));
        goto fail;
    }
    if (!S_ISREG(st.st_mode)) {
        log_error("%s: is not a regular file", path);
        goto fail;
    }
    const size_t most = limit ? limit : (size_t)4 << 30;
    if ((size_t)st.st_size > most) {
        log_error("%s: has %lld bytes, more than the %zu that are accepted", path,
                  (long long)st.st_size, most);
        goto fail;
    }
    data = mem_array((size_t)st.st_size + 1, 1);
    *size = fread(data, 1, (size_t)st.st_size, f);
    if (*size != (size_t)st.st_size) {
        log_error("%s: cannot be read: %s", path, ferror(f) ? strerror(errno) : "it shrank");
        goto fail;
    }
    fclose(f);
    return data;
fail:
    mem_free(data);
    if (f)
        fclose(f);
    return NULL;
}

const void *file_map(const char *path, size_t *size) {
    struct stat st;
    void *map = MAP_FAILED;
    const int fd = open(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st) != 0)
        log_error("%s: cannot be read: %s", path, strerror(errno));
    else if (!S_ISREG(st.st_mode) || st.st_size == 0)
        log_error("%s: is %s", path, S_ISREG(st.st_mode) ? "empty" : "not a regular file");
    else if ((map = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_SHARED, fd, 0)) == MAP_FAILED)
        log_error("%s: cannot be read: %s", path, strerror(errno));
    if (fd >= 0)
        close(fd);
    if (map == MAP_FAILED)
        return NULL;
    *size = (size_t)st.st_size;
    return map;
}

void file_unmap(const void *map, size_t size) {
    if (map)
        munmap((void *)(uintptr_t)map, size);
}

bool file_exists(const char *path) {
    return access(path, F_OK) == 0;
}

uint64_t file_hash(const void *data, size_t size, uint64_t seed) {
    uint64_t h = 0xcbf29ce484222325u ^ seed;
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 0x100000001b3u;
    return h;
}

// Renaming would replace devices, and files that are write-protected.
static bool may_replace(const char *path) {
    struct stat st;
    if (stat(path, &st) != 0)
        return true;
    if (!S_ISREG(st.st_mode)) {
        log_error("%s: is %s, expected the name of a file to write", path,
                  S_ISDIR(st.st_mode) ? "a directory" : "not a regular file");
        return false;
    }
    const bool may = (st.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) && access(path, W_OK) == 0;
    if (!may)
        log_error("%s: cannot be written: it is write-protected", path);
    return may;
}

double file_space(const char *path) {
    char directory[4096];
    struct statvfs fs;
    file_directory(path, directory, sizeof directory);
    return statvfs(directory, &fs) == 0 ? (double)fs.f_bavail * (double)fs.f_frsize : INFINITY;
}

bool file_temp_name(const char *path, char *temp, size_t n) {
    char directory[4096];
    file_directory(path, directory, sizeof directory);
    if (!may_replace(path))
        return false;
    if (access(directory, W_OK) != 0) {
        log_error("%s: cannot be written: directory %s: %s", path, directory, strerror(errno));
        return false;
    }
    if ((size_t)snprintf(temp, n, "%s.%ld.tmp", path, (long)getpid()) >= n) {
        log_error("%s: name is too long", path);
        return false;
    }
    return true;
}

bool file_commit(const char *temp, const char *path) {
    const int fd = open(temp, O_RDONLY);
    const bool synced = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0)
        close(fd);
    if (synced && rename(temp, path) == 0)
        return true;
    log_error("%s: cannot be written: %s", path, strerror(errno));
    file_discard(temp);
    return false;
}

void file_discard(const char *temp) {
    unlink(temp);
}

bool file_write(const char *path, const void *data, size_t size) {
    char temp[4096];
    if (!file_temp_name(path, temp, sizeof temp))
        return false;
    FILE *f = fopen(temp, "wb");
    const bool written = f && fwrite(data, 1, size, f) == size;
    if ((f && fclose(f) != 0) || !written) {
        log_error("%s: cannot be written: %s", path, strerror(errno));
        file_discard(temp);
        return false;
    }
    return file_commit(temp, path);
}

bool file_text_begin(struct file_text *t, const char *path) {
    *t = (struct file_text){.path = path};
    t->f = open_memstream(&t->text, &t->size);
    if (!t->f)
        log_error("%s: no memory to write it", path);
    return t->f;
}

bool file_text_end(struct file_text *t) {
    const bool whole = fclose(t->f) == 0;
    if (!whole)
        log_error("%s: no memory to write it", t->path);
    const bool written = whole && file_write(t->path, t->text, t->size);
    free(t->text);
    return written;
}

void file_directory(const char *path, char *out, size_t n) {
    const char *slash = strrchr(path, '/');
    if (!slash)
        snprintf(out, n, ".");
    else if (slash == path)
        snprintf(out, n, "/");
    else
        snprintf(out, n, "%.*s", (int)(slash - path), path);
}

void file_extension(const char *path, char *out, size_t n) {
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash ? slash : path, '.');
    size_t i = 0;
    for (const char *c = dot ? dot + 1 : ""; *c && i + 1 < n; c++)
        out[i++] = (char)tolower((unsigned char)*c);
    out[i] = '\0';
}
