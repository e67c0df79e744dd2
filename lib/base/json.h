// SPDX-License-Identifier: Apache-2.0
// JSON: building what --json prints, and reading files (glTF, headers of tensors).
//
// A value owns its children; only the root is destroyed. Numbers print with 15 digits; NaN and
// infinity, which JSON lacks, become null. Keys keep the order in which they were added.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct json; // any value

struct json *json_new_object(void);
struct json *json_new_array(void);
void json_destroy(struct json *root); // NULL is fine
struct json *json_clone(const struct json *root);

void json_add_number(struct json *object, const char *key, double value);
void json_add_count(struct json *object, const char *key, int64_t value);
void json_add_bool(struct json *object, const char *key, bool value);
void json_add_text(struct json *object, const char *key, const char *value); // NULL: null
struct json *json_add_object(struct json *object, const char *key);          // the child
struct json *json_add_array(struct json *object, const char *key);
void json_append_count(struct json *array, int64_t value);
void json_append_number(struct json *array, double value);
void json_append_text(struct json *array, const char *value);
struct json *json_append_object(struct json *array);
struct json *json_append_array(struct json *array);

// One line on standard output, or several indented ones.
void json_print(const struct json *root, bool indented);
// The same for people: a line "key: value" each, nested ones indented; arrays of plain values on
// one line.
void json_print_lines(const struct json *root);
// The same line as a text, with 17 digits, which give the same bits back; free with mem_free.
char *json_to_text(const struct json *root);
// Atomic; false after an error message.
bool json_write(const struct json *root, const char *path);

// The value a text of `size` bytes holds, no name twice in one object; NULL after an error message that names `path` and line.
struct json *json_parse(const char *text, size_t size, const char *path);

// Looking into a value: none of these reports errors; NULL and a wrong kind of value are fine, and
// give NULL, 0 or false.
const struct json *json_get(const struct json *object, const char *key);
const struct json *json_at(const struct json *array, size_t i);
size_t json_count(const struct json *container); // of an array or object
// The i-th key of an object, or NULL.
const char *json_key(const struct json *object, size_t i);
bool json_is_object(const struct json *value);
bool json_is_array(const struct json *value);
const char *json_text(const struct json *value);
bool json_read_number(const struct json *value, double *out);
bool json_read_integer(const struct json *value, int64_t *out);
bool json_read_bool(const struct json *value, bool *out);
