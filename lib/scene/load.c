// SPDX-License-Identifier: Apache-2.0
// All files of a scene as one tree: includes spliced in, $names replaced, ids collected.
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "scene/reader.h"

enum { MOST_INCLUDE_DEPTH = 16, MOST_FILES = 10000, MOST_VALUE = 1 << 20,
       HASH_PIECE = 1 << 20 };

struct variable {
    const char *name, *value;
    bool used, given; // given by the user, rather than by a <default>
};

// Files that are open, innermost first, to find cycles.
struct open_file {
    const char *path;
    const struct open_file *outer;
    int depth;
};

static bool expand_children(struct reader *r, struct xml_node *parent,
                            const struct open_file *file);

// ---- $names ---------------------------------------------------------------------------------

static struct variable *find_variable(struct reader *r, const char *name, size_t length) {
    for (size_t i = 0; i < r->variables.count; i++) {
        struct variable *v = &LIST_AT(&r->variables, struct variable, i);
        if (strncmp(v->name, name, length) == 0 && v->name[length] == '\0')
            return v;
    }
    return NULL;
}

static const char *nearest_variable(struct reader *r, const char *name, bool given) {
    const char *nearest = NULL;
    int best = 1 << 20;
    for (size_t i = 0; i < r->variables.count; i++) {
        const struct variable *v = &LIST_AT(&r->variables, struct variable, i);
        const int d = edit_distance(name, v->name);
        if ((given || !v->given) && d < best && 3 * d <= (int)strlen(v->name) + 2) {
            best = d;
            nearest = v->name;
        }
    }
    return nearest;
}

// The variable named at the start of text: the longest name that is known, as Mitsuba has it.
static struct variable *match_variable(struct reader *r, const char *text, size_t *length) {
    size_t n = 0;
    while (isalnum((unsigned char)text[n]) || text[n] == '_')
        n++;
    *length = n;
    for (size_t k = n; k > 0; k--) {
        struct variable *v = find_variable(r, text, k);
        if (v) {
            *length = k;
            return v;
        }
    }
    return NULL;
}

static bool unknown_variable(struct reader *r, const char *name, size_t length, struct where at) {
    const char *copy = arena_printf(r->arena, "%.*s", (int)length, name);
    const char *nearest = nearest_variable(r, copy, true);
    log_error_at(at, "$%s is not defined by -D or <default>%s%s%s", copy,
                 nearest ? "; did you mean $" : "", nearest ? nearest : "", nearest ? "?" : "");
    return false;
}

static bool substitute(struct reader *r, const char **value, struct where at) {
    struct list out = {0};
    bool ok = true;
    for (const char *c = *value; ok && *c;) {
        size_t length = 1;
        const char *piece = c;
        size_t piece_length = 1;
        if (c[0] == '\\' && c[1] == '$') {
            piece++;
            length = 2;
        } else if (c[0] == '$') {
            struct variable *v = match_variable(r, c + 1, &length);
            ok = v ? true : unknown_variable(r, c + 1, length, at);
            if (!ok)
                break;
            v->used = true;
            piece = v->value;
            piece_length = strlen(v->value);
            length++;
        }
        if (out.count + piece_length > MOST_VALUE) {
            log_error_at(at, "a value grows beyond %d characters", MOST_VALUE);
            ok = false;
            break;
        }
        mem_grow(&out.items, &out.capacity, out.count + piece_length + 1, 1);
        memcpy((char *)out.items + out.count, piece, piece_length);
        out.count += piece_length;
        c += length;
    }
    if (ok)
        *value = arena_printf(r->arena, "%.*s", (int)out.count, (char *)out.items);
    mem_free(out.items);
    return ok;
}

// Whether this is the type, under a name that nobody defined, of an integrator in whose place the
// user asks for another: it stays as it stands, a type that is not known.
static bool is_type_replaced(struct reader *r, const struct xml_node *node,
                             const struct xml_attribute *a) {
    size_t length;
    return r->options->integrator && strcmp(node->tag, "integrator") == 0 &&
           strcmp(a->name, "type") == 0 && a->value[0] == '$' &&
           !match_variable(r, a->value + 1, &length);
}

static bool substitute_all(struct reader *r, struct xml_node *node) {
    for (int i = 0; i < node->attribute_count; i++) {
        struct xml_attribute *a = &node->attributes[i];
        if (strchr(a->value, '$') && !is_type_replaced(r, node, a) &&
            !substitute(r, &a->value, node->at))
            return false;
    }
    return true;
}

static void define_default(struct reader *r, const struct xml_node *node) {
    const char *name = xml_get(node, "name");
    struct variable *v = find_variable(r, name, strlen(name));
    if (v)
        v->used = true;
    else
        *LIST_ADD(&r->variables, struct variable) =
            (struct variable){name, xml_get(node, "value"), true, false};
}

static bool all_variables_used(struct reader *r) {
    for (size_t i = 0; i < r->variables.count; i++) {
        const struct variable *v = &LIST_AT(&r->variables, struct variable, i);
        if (v->used)
            continue;
        const char *nearest = nearest_variable(r, v->name, false);
        log_error("%s: nothing uses -D %s=%s%s%s%s", r->scene->path, v->name, v->value,
                  nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
        return false;
    }
    return true;
}

// ---- files ----------------------------------------------------------------------------------

static bool is_file(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && S_ISREG(st.st_mode);
}

// directory/name, with the backslashes of other systems turned
static const char *join(struct reader *r, const char *directory, const char *name) {
    char *path = name[0] == '/' || strcmp(directory, ".") == 0
                     ? arena_strdup(r->arena, name)
                     : arena_printf(r->arena, "%s/%s", directory, name);
    for (char *c = path; *c; c++)
        if (*c == '\\')
            *c = '/';
    return path;
}

const char *load_find_file(struct reader *r, const char *name, struct where at) {
    char beside[PATH_MAX];
    file_directory(at.file, beside, sizeof beside);
    const char *path = join(r, beside, name);
    if (is_file(path))
        return path;
    for (size_t i = r->directories.count; i-- > 0;) {
        path = join(r, LIST_AT(&r->directories, const char *, i), name);
        if (is_file(path))
            return path;
    }
    log_error_at(at, "there is no file \"%s\" beside this one or along the search paths", name);
    return NULL;
}

bool load_hash_file(struct reader *r, const char *path) {
    for (size_t i = 0; i < r->hashed.count; i++)
        if (strcmp(LIST_AT(&r->hashed, const char *, i), path) == 0)
            return true;
    FILE *f = fopen(path, "rb");
    unsigned char *piece = mem_array(HASH_PIECE, 1);
    size_t n;
    while (f && (n = fread(piece, 1, HASH_PIECE, f)) > 0)
        r->scene->hash = file_hash(piece, n, r->scene->hash);
    const bool ok = f && !ferror(f);
    if (!ok)
        log_error("%s: cannot be read: %s", path, strerror(errno));
    if (f)
        fclose(f);
    mem_free(piece);
    if (!ok)
        return false;
    *LIST_ADD(&r->hashed, const char *) = path;
    return true;
}

static bool add_directory(struct reader *r, const struct xml_node *node) {
    struct stat st;
    char beside[PATH_MAX];
    file_directory(node->at.file, beside, sizeof beside);
    const char *path = join(r, beside, xml_get(node, "value"));
    if (stat(path, &st) != 0 || !S_ISDIR(st.st_mode)) {
        // other machines' search paths must not keep a scene from being read
        log_warn_at(node->at, "there is no folder \"%s\"", path);
        return true;
    }
    *LIST_ADD(&r->directories, const char *) = path;
    return true;
}

// ---- the tree -------------------------------------------------------------------------------

static bool check_version(const struct xml_node *root, const struct xml_node *includer,
                          bool *old) {
    const char *version = xml_get(root, "version");
    if (!version && includer) {
        *old = includer->old;
        return true;
    }
    // Before 0.4 cameras and parameters had other meanings.
    char *end;
    const long major = version ? strtol(version, &end, 10) : 0;
    if (!version || end == version || (*end != '.' && *end != '\0') || major < 0 || major > 3 ||
        (major == 0 && strtod(version, NULL) < 0.4)) {
        log_error_at(root->at, "<%s> has version \"%s\", expected 0.4 to 3.x", root->tag,
                     version ? version : "");
        return false;
    }
    *old = major < 2;
    return true;
}

static void mark_old(struct xml_node *node, bool old) {
    node->old = old;
    for (struct xml_node *c = node->first; c; c = c->next)
        mark_old(c, old);
}

static struct xml_node *load_file(struct reader *r, const char *path,
                                  const struct xml_node *includer, const struct open_file *outer) {
    if (++r->file_count > MOST_FILES) {
        log_error("%s: includes more than %d files", r->scene->path, MOST_FILES);
        return NULL;
    }
    const char *text = includer ? NULL : r->options->text;
    size_t size = text ? strlen(text) : 0;
    char *data = text ? memcpy(mem_array(size + 1, 1), text, size)
                      : file_read(path, XML_MOST_BYTES, &size);
    if (!data)
        return NULL;
    r->scene->hash = file_hash(data, size, r->scene->hash);
    struct xml_node *root = xml_parse(data, size, path, XML_TEXT_REPORTED, r->arena,
                                      &r->node_count);
    mem_free(data);
    bool old = false;
    if (root && !includer && strcmp(root->tag, "scene") != 0) {
        log_error_at(root->at, "the outermost element is <%s>, expected <scene>", root->tag);
        return NULL;
    }
    if (!root || !check_version(root, includer, &old))
        return NULL;
    mark_old(root, old);
    const struct open_file file = {path, outer, outer ? outer->depth + 1 : 0};
    if (!substitute_all(r, root) || !dialect_check(r, root) || !expand_children(r, root, &file) ||
        (old && !dialect_upgrade_object(r, root)))
        return NULL;
    return root;
}

static bool include(struct reader *r, struct xml_node *parent, const struct xml_node *node,
                    const struct open_file *file) {
    const char *path = load_find_file(r, xml_get(node, "filename"), node->at);
    if (!path)
        return false;
    for (const struct open_file *f = file; f; f = f->outer) {
        char a[PATH_MAX], b[PATH_MAX];
        if (realpath(f->path, a) && realpath(path, b) && strcmp(a, b) == 0) {
            log_error_at(node->at, "includes \"%s\", which includes this file: a cycle", path);
            return false;
        }
    }
    if (file->depth + 1 >= MOST_INCLUDE_DEPTH) {
        log_error_at(node->at, "includes are nested more than %d deep", MOST_INCLUDE_DEPTH);
        return false;
    }
    struct xml_node *root = load_file(r, path, node, file);
    if (!root)
        return false;
    if (strcmp(root->tag, "scene") != 0) { // the file is one object
        xml_append(parent, root);
        const char *id = xml_get(root, "id");
        return !id || id_define(r, id, root, root->at);
    }
    for (struct xml_node *c = root->first, *next; c; c = next) {
        next = c->next;
        xml_append(parent, c);
    }
    return true;
}

static bool make_alias(struct reader *r, const struct xml_node *node) {
    struct id_entry *e = id_find(r, xml_get(node, "id"));
    if (!e) {
        log_error_at(node->at, "nothing before this has the id \"%s\"", xml_get(node, "id"));
        return false;
    }
    // a reference that forwards, so that the object stays one
    struct xml_node *ref = xml_new("ref", node->at, r->arena);
    xml_set(ref, "id", xml_get(node, "id"), r->arena);
    return id_define(r, xml_get(node, "as"), ref, node->at);
}

static bool structure(struct reader *r, struct xml_node *parent, struct xml_node *node,
                      const struct open_file *file) {
    if (strcmp(node->tag, "include") == 0)
        return include(r, parent, node, file);
    if (strcmp(node->tag, "alias") == 0)
        return make_alias(r, node);
    if (strcmp(node->tag, "path") == 0)
        return add_directory(r, node);
    define_default(r, node);
    return true;
}

static bool expand_node(struct reader *r, struct xml_node *parent, struct xml_node *node,
                        const struct open_file *file) {
    if (!substitute_all(r, node) || !dialect_check(r, node))
        return false;
    const enum tag_kind kind = tag_kind(node);
    const char *id = xml_get(node, "id");
    if (kind == TAG_STRUCTURE)
        return structure(r, parent, node, file);
    if (kind == TAG_SKIPPED) {
        ignore_name(r, arena_printf(r->arena, "<%s>", node->tag), node->at);
        return true;
    }
    if (kind == TAG_OBJECT && id && !id_define(r, id, node, node->at))
        return false;
    if (!expand_children(r, node, file))
        return false;
    if (kind == TAG_OBJECT && node->old && !dialect_upgrade_object(r, node))
        return false;
    xml_append(parent, node);
    return true;
}

static bool expand_children(struct reader *r, struct xml_node *parent,
                            const struct open_file *file) {
    struct xml_node *child = parent->first;
    parent->first = parent->last = NULL;
    while (child) {
        struct xml_node *next = child->next;
        if (!expand_node(r, parent, child, file))
            return false;
        child = next;
    }
    return true;
}

struct xml_node *load_scene_tree(struct reader *r, const char *path) {
    char directory[PATH_MAX];
    file_directory(path, directory, sizeof directory);
    *LIST_ADD(&r->directories, const char *) = arena_strdup(r->arena, directory);
    for (size_t i = 0; i < r->options->define_count; i++)
        *LIST_ADD(&r->variables, struct variable) = (struct variable){
            r->options->defines[i].name, r->options->defines[i].value, false, true};
    struct xml_node *root = load_file(r, path, NULL, NULL);
    return root && all_variables_used(r) ? root : NULL;
}
