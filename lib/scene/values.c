// SPDX-License-Identifier: Apache-2.0
// The text of attributes as numbers, vectors and transforms.
#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "scene/reader.h"

int value_numbers(const char *text, double *out, int most) {
    int count = 0;
    const char *c = text;
    for (;;) {
        while (isspace((unsigned char)*c) || *c == ',')
            c++;
        if (*c == '\0')
            return count;
        char *end;
        const double v = strtod(c, &end);
        if (end == c || !isfinite(v) || (*end && !isspace((unsigned char)*end) && *end != ','))
            return -1;
        if (count < most)
            out[count] = v;
        count++;
        c = end;
    }
}

static const char *value_of(const struct xml_node *node) {
    const char *text = xml_get(node, "value");
    return text ? text : "";
}

bool value_number(const struct xml_node *node, double *out) {
    if (value_numbers(value_of(node), out, 1) == 1)
        return true;
    log_error_at(node->at, "<%s> has the value \"%s\", expected a finite number", node->tag,
                 value_of(node));
    return false;
}

bool value_integer(const struct xml_node *node, long long *out) {
    char *end;
    const char *text = value_of(node);
    errno = 0;
    *out = strtoll(text, &end, 10);
    while (end != text && isspace((unsigned char)*end))
        end++;
    if (end != text && *end == '\0' && errno == 0)
        return true;
    log_error_at(node->at, "<%s> has the value \"%s\", expected a whole number", node->tag, text);
    return false;
}

bool value_boolean(const struct xml_node *node, bool *out) {
    const char *text = value_of(node);
    *out = strcmp(text, "true") == 0 || strcmp(text, "True") == 0;
    if (*out || strcmp(text, "false") == 0 || strcmp(text, "False") == 0)
        return true;
    log_error_at(node->at, "<%s> has the value \"%s\", expected true or false", node->tag, text);
    return false;
}

static bool read_component(const struct xml_node *node, const char *name, double *out) {
    const char *text = xml_get(node, name);
    if (!text || value_numbers(text, out, 1) == 1)
        return true;
    log_error_at(node->at, "<%s> has %s = \"%s\", expected a finite number", node->tag, name, text);
    return false;
}

bool value_vector(const struct xml_node *node, double missing, double out[3]) {
    const char *value = xml_get(node, "value");
    const bool parts = xml_get(node, "x") || xml_get(node, "y") || xml_get(node, "z");
    if (value && parts) {
        log_error_at(node->at, "<%s> has both value and x, y, z", node->tag);
        return false;
    }
    for (int k = 0; k < 3; k++)
        out[k] = missing;
    if (!value)
        return read_component(node, "x", &out[0]) && read_component(node, "y", &out[1]) &&
               read_component(node, "z", &out[2]);
    const int n = value_numbers(value, out, 3);
    if (n == 1)
        out[1] = out[2] = out[0];
    if (n == 1 || n == 3)
        return true;
    log_error_at(node->at, "<%s> has the value \"%s\", expected one or three numbers", node->tag,
                 value);
    return false;
}

// ---- transforms -----------------------------------------------------------------------------

static bool read_three(const struct xml_node *node, const char *name, double out[3]) {
    const char *text = xml_get(node, name);
    if (text && value_numbers(text, out, 3) == 3)
        return true;
    log_error_at(node->at, "<%s> has %s = \"%s\", expected three numbers", node->tag, name,
                 text ? text : "");
    return false;
}

static bool read_look_at(const struct xml_node *node, struct transform *step) {
    double origin[3], target[3], up[3] = {0, 0, 0};
    if (!read_three(node, "origin", origin) || !read_three(node, "target", target) ||
        (xml_get(node, "up") && !read_three(node, "up", up)))
        return false;
    if (up[0] == 0 && up[1] == 0 && up[2] == 0) { // any that is not parallel to the view
        const double dx = fabs(target[0] - origin[0]), dz = fabs(target[2] - origin[2]);
        up[dx < dz ? 0 : 2] = 1;
    }
    if (transform_look_at(origin, target, up, step))
        return true;
    log_error_at(node->at, "<lookat>: origin and target coincide, or up is parallel to the view");
    return false;
}

static bool read_rotate(const struct xml_node *node, struct transform *step) {
    double axis[3], angle;
    if (!value_vector(node, 0, axis) || !read_component(node, "angle", &angle))
        return false;
    if (axis[0] == 0 && axis[1] == 0 && axis[2] == 0) {
        log_error_at(node->at, "<rotate> has no axis");
        return false;
    }
    *step = transform_rotate(axis, angle);
    return true;
}

static bool read_matrix(const struct xml_node *node, struct transform *step) {
    double v[16];
    const int n = value_numbers(value_of(node), v, 16);
    if (n != 16 && n != 9) {
        log_error_at(node->at, "<matrix> has %s, expected 16 or 9 finite numbers",
                     n < 0 ? "something that is not a number" : n == 0 ? "none" : "other than that");
        return false;
    }
    const int side = n == 16 ? 4 : 3;
    *step = transform_identity;
    for (int i = 0; i < n; i++)
        step->m[i / side][i % side] = v[i];
    if (transform_make_affine(step))
        return true;
    log_error_at(node->at, "<matrix> has %g %g %g %g as its last row, expected 0 0 0 1: no projection",
                 v[12], v[13], v[14], v[15]);
    return false;
}

static bool read_step(const struct xml_node *node, struct transform *step) {
    double v[3];
    if (strcmp(node->tag, "translate") == 0) {
        if (!value_vector(node, 0, v))
            return false;
        *step = transform_translate(v[0], v[1], v[2]);
        return true;
    }
    if (strcmp(node->tag, "scale") == 0) {
        if (!value_vector(node, 1, v))
            return false;
        *step = transform_scale(v[0], v[1], v[2]);
        return true;
    }
    if (strcmp(node->tag, "rotate") == 0)
        return read_rotate(node, step);
    if (strcmp(node->tag, "lookat") == 0)
        return read_look_at(node, step);
    if (strcmp(node->tag, "matrix") == 0)
        return read_matrix(node, step);
    log_error_at(node->at, "<%s> inside <transform>, expected translate, rotate, scale, lookat or "
                 "matrix", node->tag);
    return false;
}

bool value_transform(const struct xml_node *node, struct transform *out) {
    *out = transform_identity;
    for (const struct xml_node *child = node->first; child; child = child->next) {
        struct transform step;
        if (!read_step(child, &step))
            return false;
        *out = transform_multiply(&step, out);
    }
    struct transform inverse;
    if (transform_is_finite(out) && transform_invert(out, &inverse))
        return true;
    log_error_at(node->at, "this transform has no inverse");
    return false;
}
