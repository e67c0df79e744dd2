// SPDX-License-Identifier: Apache-2.0
// Messages between the processes of driver/ranks.h.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Short ones, which are there at once: the receiver must ask for as much.
void rank_send(int rank, int tag, const void *data, size_t size);
void rank_receive(int rank, int tag, void *data, size_t size);

// A long one on its way, while both ends work on: waiting for the other's next look at it would idle.
struct rank_message;

struct rank_message *rank_message_create(void);
void rank_message_destroy(struct rank_message *m); // waits until it is gone; NULL is fine
// Room for so many words to send, once what was in it is gone.
uint64_t *rank_message_room(struct rank_message *m, size_t words);
void rank_message_send(struct rank_message *m, int rank, int tag);
// Begins to receive one, if one waits. m must be free.
bool rank_message_begin(struct rank_message *m, int tag, int *rank);
// What was begun: its words, which belong to the message, or NULL while some are still on their way.
const uint64_t *rank_message_words(struct rank_message *m);
