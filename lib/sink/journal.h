// SPDX-License-Identifier: Apache-2.0
// The journal: a file that sums are taken up from again, to go on with them or to merge them.
//
// It is only ever appended to, so that whatever is killed at whatever moment leaves what was there.
// Layout, little-endian:
//
//     "relumeJ1"  u64 bytes of the head  u64 hash of the head  the head: JSON, what is being summed
//     then records  u32 seed  u32 level  u64 index  u32 missing  u32 0  u64 hash  doubles
//
// Hashes are 64-bit FNV-1a; a record's covers what stands before it in the record, then the doubles.
// A record replaces the nodes that lie inside its own. The file ends at the first record that is
// incomplete or damaged.
#pragma once

#include "base/json.h"
#include "sink/sums.h"

struct journal;

// Where the journal of a picture is: PICTURE.journal. false after an error message: too long.
bool journal_path(const char *picture, char *path, size_t size);

// Writes a journal with these sums and, unless NULL, a short block, in place of the file that may be
// there, and keeps it open for more. NULL after an error message: the old file is as it was.
struct journal *journal_create(const char *path, const struct json *head, const struct sums *sums,
                               const struct sums_node *short_block);
// Appends the nodes that are not in the file yet, and brings them to the disk. A file that has
// grown to several times what it needs is written anew. false after an error message: what was in
// the file stays valid.
bool journal_update(struct journal *j, const struct sums *sums,
                    const struct sums_node *short_block);
void journal_close(struct journal *j); // NULL is fine

// Reads a journal: the head, for json_destroy, and its nodes. false after an error message. A
// damaged end is dropped with a warning.
bool journal_read(const char *path, struct json **head, struct sums *sums);
