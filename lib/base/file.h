// SPDX-License-Identifier: Apache-2.0
// Files: reading whole ones, finding them along search paths, and writing so that nothing is lost.
//
// An output is written under a temporary name beside the target and renamed when it is complete:
// a killed run leaves the old file.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// The whole file and a terminating zero byte; free with mem_free. NULL after an error message.
// A file above `limit` bytes (0: 4 GiB) is refused.
char *file_read(const char *path, size_t limit, size_t *size);

// The whole file as it lies on the disk, of which only what is looked at is read. Not empty. NULL after an
// error message. A file that others shorten meanwhile kills the program.
const void *file_map(const char *path, size_t *size);
void file_unmap(const void *map, size_t size);

bool file_exists(const char *path);
// Bytes that are free where the file lies or will; infinite where that is not known.
double file_space(const char *path);
uint64_t file_hash(const void *data, size_t size, uint64_t seed); // FNV-1a, 64 bits

// Writes "PATH.PID.tmp" into temp (size n) after checking that the directory of path is writable and
// that path is free or a regular file that may be replaced; false after an error message.
bool file_temp_name(const char *path, char *temp, size_t n);
// Flushes temp to disk and renames it to path; on failure removes temp and reports.
bool file_commit(const char *temp, const char *path);
void file_discard(const char *temp);
// Writes a complete small file atomically.
bool file_write(const char *path, const void *data, size_t size);

// A text that is composed in memory and then written as one such file.
struct file_text {
    const char *path;
    FILE *f; // where it is printed to
    char *text;
    size_t size;
};

// `path` must stay until the end. false after an error message.
bool file_text_begin(struct file_text *t, const char *path);
bool file_text_end(struct file_text *t);

// Part of path before the last '/', without it ("." if none), into out (size n).
void file_directory(const char *path, char *out, size_t n);
// Lower-case characters after the last '.' of the file name, or "".
void file_extension(const char *path, char *out, size_t n);
