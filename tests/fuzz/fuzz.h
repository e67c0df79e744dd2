// SPDX-License-Identifier: Apache-2.0
// The loop of the fuzz drivers: damaged copies of good files are read in child processes that may
// take 10 seconds of processor time and 1 GiB (memory_limit.h); each is read, or refused with a
// message that names the file.
//
// usage: DRIVER [--count N] [--full N] [--seed S] FILE...
//   --count  number of copies, spread evenly over the files (default 200); --full: instead of it
//            when RELUME_TEST_FULL is set
//   FILE     "@/PATH" is relative to $RELUME_SHARED_DATA, and left out when that is not set
// Exit status: 0, or 1 when a copy crashed (also in a decoder's own process), hung or was refused
// without a word; its file is kept in the working directory, the messages beside it. 77: no file to start from.
#pragma once

#include <stdbool.h>

// Reads the file as the program would. true: it was read, and what was read is sound
// (assert the rest). false: it was refused.
typedef bool (*fuzz_reader)(const char *path);

int fuzz_main(int argc, char **argv, const char *name, fuzz_reader read);
