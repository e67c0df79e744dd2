// SPDX-License-Identifier: Apache-2.0
// JSON: what is built is what is read back; odd numbers and texts harm nothing.
#include "check.h"

#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "capture.h"

static void built_values_come_back(void) {
    struct json *root = json_new_object();
    json_add_number(root, "pi", 3.25);
    json_add_count(root, "big", INT64_MAX);
    json_add_bool(root, "yes", true);
    json_add_text(root, "text", "a \"quoted\"\nline");
    json_add_text(root, "bytes", "caf\xe9"); // not UTF-8
    json_add_number(root, "nan", NAN);
    json_add_number(root, "inf", -INFINITY);
    struct json *list = json_add_array(root, "list");
    json_append_number(list, 1);
    json_append_text(list, "two");
    json_add_bool(json_append_object(list), "inside", false);
    json_append_number(json_append_array(list), 4);
    CHECK(json_write(root, "json_test.json"));
    json_destroy(root);

    size_t size = 0;
    char *text = file_read("json_test.json", 0, &size);
    unlink("json_test.json");
    struct json *back = text ? json_parse(text, size, "json_test.json") : NULL;
    mem_free(text);
    CHECK(back);
    double number = 0;
    int64_t integer = 0;
    bool truth = false;
    CHECK(json_read_number(json_get(back, "pi"), &number) && number == 3.25);
    CHECK(json_read_integer(json_get(back, "big"), &integer) && integer == INT64_MAX);
    CHECK(json_read_bool(json_get(back, "yes"), &truth) && truth);
    CHECK(strcmp(json_text(json_get(back, "text")), "a \"quoted\"\nline") == 0);
    CHECK(strcmp(json_text(json_get(back, "bytes")), "caf?") == 0);
    CHECK(!json_read_number(json_get(back, "nan"), &number) && json_get(back, "inf"));
    const struct json *items = json_get(back, "list");
    CHECK(json_is_array(items) && json_count(items) == 4 && !json_is_object(items));
    CHECK(json_read_bool(json_get(json_at(items, 2), "inside"), &truth) && !truth);
    CHECK(json_count(json_at(items, 3)) == 1);
    CHECK(strcmp(json_key(back, 1), "big") == 0 && !json_key(back, 99));
    json_destroy(back);
}

static void looking_into_the_wrong_kind_gives_nothing(void) {
    double number;
    struct json *v = json_parse("[1]", 3, "list");
    CHECK(!json_get(v, "a") && !json_at(v, 1) && !json_text(v) && !json_read_number(v, &number));
    CHECK(!json_get(NULL, "a") && !json_at(NULL, 0) && json_count(NULL) == 0 && !json_text(NULL));
    CHECK(!json_key(NULL, 0) && !json_is_object(NULL) && !json_read_number(NULL, &number));
    json_destroy(v);
    json_destroy(NULL);
}

static void broken_text_is_refused_with_its_line(void) {
    static const char *const broken[] = {"", "{", "{\n\"a\": 1,\n}", "[1, 2", "nul", "{\"a\" 1}",
                                         "[1] [2]", "[1e999]", "\"\xff\""};
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        capture_begin();
        struct json *v = json_parse(broken[i], strlen(broken[i]), "broken.json");
        capture_end();
        CHECK(!v && captured_has("broken.json"));
        json_destroy(v);
    }
    capture_begin();
    CHECK(!json_parse(broken[2], strlen(broken[2]), "broken.json"));
    capture_end();
    CHECK(captured_has("broken.json:3"));
    static const char twice[] = "{\"a\": 1,\n\"a\": 2}"; // which of them is meant?
    capture_begin();
    CHECK(!json_parse(twice, sizeof twice - 1, "twice.json"));
    capture_end();
    CHECK(captured_has("twice.json:2") && captured_has("duplicate") && captured_has("\"a\""));
    char deep[100001]; // a stack of brackets must not overflow ours
    memset(deep, '[', sizeof deep - 1);
    capture_begin();
    CHECK(!json_parse(deep, sizeof deep - 1, "deep.json"));
    capture_end();
}

int main(void) {
    built_values_come_back();
    looking_into_the_wrong_kind_gives_nothing();
    broken_text_is_refused_with_its_line();
    return check_result();
}
