// SPDX-License-Identifier: Apache-2.0
#include "table/window.h"

#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/log.h"
#include "base/text.h"
#include "base/xml.h"

enum { MOST_DEPTH = 12, MOST_CELL_SIDE = 32 };

static const float LARGEST = 1e12f; // what lies beyond is damage

struct basis {
    const char *name;
    struct window_cells cells;
};

static const struct basis known_bases[] = {
    {"LBNL/Klems Full", {0, 9, 145, {0, 5, 15, 25, 35, 45, 55, 65, 75, 90},
                         {1, 8, 16, 20, 24, 24, 24, 16, 12}}},
    {"LBNL/Klems Half", {0, 7, 77, {0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90},
                         {1, 8, 12, 16, 20, 12, 8}}},
    {"LBNL/Klems Quarter", {0, 5, 41, {0, 9, 27, 45, 63, 90}, {1, 8, 12, 12, 8}}},
};

enum { KNOWN_BASES = sizeof known_bases / sizeof *known_bases, MOST_BASES = 8 };

struct reader {
    const char *path;
    struct arena *arena;
    struct window_table *t;
    struct basis bases[MOST_BASES]; // of the file
    int base_count, rank;
    bool rows; // the matrix lists outgoing directions first
};

static const char *text_of(const struct xml_node *node, const char *tag) {
    const struct xml_node *child = node ? xml_child(node, tag) : NULL;
    const char *text = child && child->text ? child->text : "";
    while (text_is_space(*text))
        text++;
    return text;
}

// Whether the text is that word, blanks after it apart.
static bool is(const char *text, const char *word) {
    const size_t n = strlen(word);
    if (strncasecmp(text, word, n) != 0)
        return false;
    while (text_is_space(text[n]))
        text++;
    return text[n] == '\0';
}

static bool fail(const struct xml_node *at, const char *message, const char *detail) {
    log_error_at(at->at, "%s%s", message, detail);
    return false;
}

// ---- patches --------------------------------------------------------------------------------

static bool read_ring(const struct xml_node *block, struct window_cells *c) {
    const struct xml_node *bounds = xml_child(block, "ThetaBounds");
    const char *upper = text_of(bounds, "UpperTheta"), *count = text_of(block, "nPhis");
    int64_t n;
    double theta;
    if (c->rings == WINDOW_MOST_RINGS || !text_number(&upper, &theta) ||
        !text_integer(&count, &n) || n < 1 || n > 360 || !(theta > c->theta[c->rings]) ||
        theta > 90 || c->count + n > WINDOW_MOST_CELLS)
        return fail(block, "expected ascending UpperTheta up to 90 and nPhis of 1 to 360", "");
    c->sectors[c->rings++] = (int)n;
    c->theta[c->rings] = theta;
    c->count += (int)n;
    return true;
}

static bool read_bases(struct reader *r, const struct xml_node *definition) {
    for (struct xml_node *b = definition->first; b; b = b->next) {
        if (strcmp(b->tag, "AngleBasis") != 0)
            continue;
        if (r->base_count == MOST_BASES)
            return fail(b, "more angle bases than are accepted", "");
        struct basis *basis = &r->bases[r->base_count++];
        basis->name = text_of(b, "AngleBasisName");
        for (struct xml_node *k = b->first; k; k = k->next)
            if (strcmp(k->tag, "AngleBasisBlock") == 0 && !read_ring(k, &basis->cells))
                return false;
        if (basis->cells.rings == 0 || basis->cells.theta[basis->cells.rings] < 89.9)
            return fail(b, "the angle basis does not reach 90 degrees", "");
    }
    return true;
}

static bool find_basis(const struct reader *r, const struct xml_node *block, const char *tag,
                       struct window_cells *cells) {
    char word[64];
    const char *name = text_of(block, tag);
    size_t n = strcspn(name, "\r\n\t");
    n = n < sizeof word ? n : sizeof word - 1;
    memcpy(word, name, n);
    word[n] = '\0';
    for (int i = 0; i < r->base_count + KNOWN_BASES; i++) {
        const struct basis *b =
            i < r->base_count ? &r->bases[i] : &known_bases[i - r->base_count];
        if (is(word, b->name)) {
            *cells = b->cells;
            return true;
        }
    }
    return fail(block, "the angle basis is not known: ", word);
}

// ---- values ---------------------------------------------------------------------------------

static void skip(const char **p) {
    while (text_is_space(**p) || **p == ',')
        ++*p;
}

// A value; words and values that cannot be count as 0. false: there is none before a brace or the end.
static bool read_value(struct reader *r, const char **p, float *out) {
    double v;
    skip(p);
    if (**p == '\0' || **p == '{' || **p == '}')
        return false;
    if (!text_number(p, &v)) {
        v = -1;
        *p += strcspn(*p, " \t\r\n,{}");
    }
    const bool good = v >= 0 && v <= (double)LARGEST;
    r->t->invalid += !good;
    *out = good ? (float)v : 0;
    return true;
}

static bool read_matrix(struct reader *r, const struct xml_node *block, struct window_part *part) {
    const char *p = text_of(block, "ScatteringData");
    if (!find_basis(r, block, "ColumnAngleBasis", &part->in) ||
        !find_basis(r, block, "RowAngleBasis", &part->out))
        return false;
    const int ins = part->in.count, outs = part->out.count, n = ins * outs;
    if ((size_t)n > strlen(p))
        return fail(block, "there are fewer values than pairs of patches", "");
    float *values = arena_alloc(r->arena, (size_t)n * sizeof *values), v;
    for (int k = 0; k < n; k++) {
        if (!read_value(r, &p, &v))
            return fail(block, "there are fewer values than pairs of patches", "");
        values[r->rows ? k % outs * ins + k / outs : k] = v;
    }
    part->values = values;
    part->rank = 2;
    return true;
}

struct tree {
    struct reader *r;
    const struct xml_node *at;
    const char *p;
    struct window_node *nodes;
    size_t node_count, node_capacity;
    float *values;
    size_t value_count, value_capacity;
    int depth; // of the finest value
};

static size_t new_nodes(struct tree *t, size_t count) {
    const size_t first = t->node_count;
    mem_grow(&t->nodes, &t->node_capacity, first + count, sizeof *t->nodes);
    t->node_count += count;
    return first;
}

static bool read_leaf(struct tree *t, size_t node, int depth) {
    const size_t first = t->value_count;
    float v;
    while (read_value(t->r, &t->p, &v)) {
        mem_grow(&t->values, &t->value_capacity, t->value_count + 1, sizeof v);
        t->values[t->value_count++] = v;
    }
    int log2 = 0;
    while (log2 * t->r->rank < 30 && (size_t)1 << (log2 * t->r->rank) < t->value_count - first)
        log2++;
    if ((size_t)1 << (log2 * t->r->rank) != t->value_count - first)
        return fail(t->at, "a grid of the tensor tree has a number of values that is no power", "");
    t->nodes[node] = (struct window_node){-1, log2, (uint32_t)first};
    t->depth = depth + log2 > t->depth ? depth + log2 : t->depth;
    return true;
}

static bool expect(struct tree *t, char brace) {
    const char text[2] = {brace, 0};
    skip(&t->p);
    if (*t->p != brace)
        return fail(t->at, "the tensor tree lacks a ", text);
    t->p++;
    return true;
}

static bool read_node(struct tree *t, size_t node, int depth) {
    if (depth > MOST_DEPTH)
        return fail(t->at, "the tensor tree is too deep", "");
    if (!expect(t, '{'))
        return false;
    skip(&t->p);
    if (*t->p == '{') {
        const size_t count = (size_t)1 << t->r->rank, first = new_nodes(t, count);
        t->nodes[node] = (struct window_node){(int32_t)first, 0, 0};
        for (size_t i = 0; i < count; i++)
            if (!read_node(t, first + i, depth + 1))
                return false;
    } else if (!read_leaf(t, node, depth)) {
        return false;
    }
    return expect(t, '}');
}

static bool read_tree(struct reader *r, const struct xml_node *block, struct window_part *part) {
    struct tree t = {.r = r, .at = block, .p = text_of(block, "ScatteringData")};
    if (!is(text_of(block, "AngleBasis"), "LBNL/Shirley-Chiu"))
        return fail(block, "expected the AngleBasis LBNL/Shirley-Chiu", "");
    bool good = read_node(&t, new_nodes(&t, 1), 0);
    skip(&t.p);
    if (good && *t.p)
        good = fail(block, "there is something after the tensor tree", "");
    if (good) {
        part->rank = r->rank;
        part->nodes = memcpy(arena_alloc(r->arena, t.node_count * sizeof *t.nodes), t.nodes,
                             t.node_count * sizeof *t.nodes);
        part->values = memcpy(arena_alloc(r->arena, t.value_count * sizeof *t.values), t.values,
                              t.value_count * sizeof *t.values);
        const int side = 1 << (t.depth < 5 ? t.depth : 5);
        part->out.side = side < 4 ? 4 : side > MOST_CELL_SIDE ? MOST_CELL_SIDE : side;
        part->out.count = part->out.side * part->out.side;
        part->in.side = part->out.side < 16 ? part->out.side : 16;
        part->in.count = part->in.side * part->in.side;
    }
    mem_free(t.nodes);
    mem_free(t.values);
    return good;
}

// ---- the file -------------------------------------------------------------------------------

static bool read_block(struct reader *r, const struct xml_node *block) {
    static const char *const names[WINDOW_PARTS] = {"Reflection Back", "Reflection Front",
                                                    "Transmission Back", "Transmission Front"};
    const char *direction = text_of(block, "WavelengthDataDirection");
    for (int i = 0; i < WINDOW_PARTS; i++)
        if (is(direction, names[i])) {
            if (r->t->parts[i].rank)
                return fail(block, "is given twice: ", names[i]);
            return r->rank == 2 ? read_matrix(r, block, &r->t->parts[i])
                                : read_tree(r, block, &r->t->parts[i]);
        }
    return fail(block, "the WavelengthDataDirection is not known", "");
}

static bool read_layer(struct reader *r, const struct xml_node *layer) {
    const struct xml_node *definition = xml_child(layer, "DataDefinition");
    const char *structure = text_of(definition, "IncidentDataStructure");
    bool any = false;
    r->rank = is(structure, "TensorTree3") ? 3 : is(structure, "TensorTree4") ? 4 : 2;
    r->rows = is(structure, "Rows");
    if (!definition || (r->rank == 2 && !r->rows && !is(structure, "Columns")))
        return fail(layer, "expected an IncidentDataStructure of Columns, Rows, TensorTree3 or "
                           "TensorTree4", "");
    if (!read_bases(r, definition))
        return false;
    for (struct xml_node *w = layer->first; w; w = w->next) {
        if (strcmp(w->tag, "WavelengthData") != 0 || !is(text_of(w, "Wavelength"), "Visible"))
            continue;
        for (struct xml_node *b = w->first; b; b = b->next)
            if (strcmp(b->tag, "WavelengthDataBlock") == 0) {
                if (!read_block(r, b))
                    return false;
                any = true;
            }
    }
    return any || fail(layer, "there are no data of the visible range", "");
}

struct window_table *window_read(const char *path, struct arena *arena) {
    struct reader r = {.path = path, .arena = arena, .t = arena_alloc(arena, sizeof *r.t)};
    struct arena tree = {0};
    size_t size, nodes = 0;
    char *data = file_read(path, XML_MOST_BYTES, &size);
    struct xml_node *root =
        data ? xml_parse(data, size, path, XML_TEXT_KEPT, &tree, &nodes) : NULL;
    const struct xml_node *optical = root ? xml_child(root, "Optical") : NULL;
    const struct xml_node *layer = optical ? xml_child(optical, "Layer") : NULL;
    mem_free(data);
    if (root && !layer)
        log_error("%s: is not a window material: expected <WindowElement><Optical><Layer>", path);
    const bool good = layer && read_layer(&r, layer);
    arena_finish(&tree);
    if (good && r.t->invalid)
        log_warn("%s: %zu values are negative or no numbers; taken as 0", path, r.t->invalid);
    return good ? r.t : NULL;
}
