// SPDX-License-Identifier: Apache-2.0
// The loop of the fuzz drivers: good files and damaged copies of them are read in child processes that
// may take 10 seconds of processor time and 1 GiB (memory_limit.h); a good file must be read, a copy
// be read or refused with a message that names the file.
//
// usage: DRIVER [--count N] [--full N] [--seed S] FILE... [--refused FILE...]
//   --count  number of cases, spread evenly over the files, of which the first is the file as it is
//            (default 200); --full: instead of it when RELUME_TEST_FULL is set
//   --refused  what follows is no good file, as where a good one would be too large
//   FILE     "@/PATH" is relative to $RELUME_SHARED_DATA, and left out when that is not set
// Exit status: 0, or 1 when a case crashed (also in a decoder's own process), hung or was refused
// without a word, or when it is good and was refused; its file is kept in the working directory, the messages beside it. 77: no file to start from.
#pragma once

#include <stdbool.h>

// Reads the file as the program would. true: it was read, and what was read is sound
// (assert the rest). false: it was refused.
typedef bool (*fuzz_reader)(const char *path);

int fuzz_main(int argc, char **argv, const char *name, fuzz_reader read);
