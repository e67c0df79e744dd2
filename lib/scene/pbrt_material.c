// SPDX-License-Identifier: Apache-2.0
// Materials of pbrt. Opaque ones reflect on both sides there: twosided.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/pbrt.h"

// A material without name inside another, which is held by its place.
static struct xml_node *inside(struct pbrt *p, struct pbrt_call *c, struct xml_node *out,
                               const char *wrapper) {
    pbrt_set_type(p, out, wrapper);
    return pbrt_add(p, out, "bsdf", NULL, NULL, c->at);
}

// Inside what "normalmap" and "displacement" do to the normals; NULL after an error message.
static struct xml_node *perturbed(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const char *map = pbrt_string(c, "normalmap", NULL, &good);
    if (map) {
        pbrt_set_type(p, out, "normalmap");
        struct xml_node *texture = pbrt_add(p, out, "texture", "bitmap", NULL, c->at);
        xml_set(texture, "name", "normalmap", p->r->arena);
        tree_text(p->r, texture, "string", "filename", map);
        tree_text(p->r, texture, "boolean", "raw", "true");
        struct transform flip = transform_scale(1, -1, 1);
        flip.m[1][3] = 1;
        tree_transform(p->r, texture, "to_uv", &flip);
        out = pbrt_add(p, out, "bsdf", NULL, NULL, c->at);
    } else if (pbrt_find(c, "texture|float", "displacement", &good) && good) {
        pbrt_set_type(p, out, "bumpmap");
        good = pbrt_put_texture(p, c, "displacement", out, "texture", true);
        out = pbrt_add(p, out, "bsdf", NULL, NULL, c->at);
    }
    return good ? out : NULL;
}

static struct xml_node *opaque(struct pbrt *p, struct pbrt_call *c, struct xml_node *out,
                               const char *type) {
    struct xml_node *base = perturbed(p, c, inside(p, c, out, "twosided"));
    if (base)
        pbrt_set_type(p, base, type);
    return base;
}

// ---- roughness ----------------------------------------------------------------------------------

struct roughness {
    double u, v;
    bool textured, smooth;
};

static const char *const plain_roughness[3] = {"roughness", "uroughness", "vroughness"};

// alpha = sqrt(roughness) unless "remaproughness" is false (pbrt's RoughnessToAlpha). names: of both
// directions, of u, of v.
static bool read_roughness(struct pbrt *p, struct pbrt_call *c, const char *const names[3],
                           struct roughness *out) {
    bool good = true;
    double v[3] = {0, -1, -1};
    const bool remap = pbrt_bool(c, "remaproughness", true, &good);
    *out = (struct roughness){0};
    for (int i = 0; i < 3; i++) {
        const struct pbrt_param *a = pbrt_find(c, "texture|float", names[i], &good);
        out->textured |= a && a->texts;
        if (a && a->numbers)
            v[i] = remap ? sqrt(fmax(a->numbers[0], 0)) : fmax(a->numbers[0], 0);
    }
    out->u = fmin(v[1] >= 0 ? v[1] : v[0], 1000);
    out->v = fmin(v[2] >= 0 ? v[2] : v[0], 1000);
    out->smooth = !out->textured && fmax(out->u, out->v) < 1e-3; // TrowbridgeReitz EffectivelySmooth
    if (out->textured && remap)
        pbrt_warn(p, c->at, "a textured roughness is taken for alpha, without the square root");
    return good;
}

static bool put_roughness(struct pbrt *p, struct pbrt_call *c, const char *const names[3],
                          const struct roughness *r, struct xml_node *out) {
    tree_text(p->r, out, "string", "distribution", "ggx");
    if (r->textured) {
        bool good = true;
        const bool single = pbrt_find(c, "texture|float", names[0], &good) != NULL;
        return single ? pbrt_put_texture(p, c, names[0], out, "alpha", true)
                      : pbrt_put_texture(p, c, names[1], out, "alpha_u", true) &&
                            pbrt_put_texture(p, c, names[2], out, "alpha_v", true);
    }
    if (r->u == r->v) {
        tree_number(p->r, out, "alpha", r->u);
    } else {
        tree_number(p->r, out, "alpha_u", r->u);
        tree_number(p->r, out, "alpha_v", r->v);
    }
    return true;
}

// Indices of glasses at 589 nm, of pbrt's named spectra.
static bool read_eta(struct pbrt *p, struct pbrt_call *c, const char *name, double *eta) {
    static const struct {
        const char *name;
        double eta;
    } glasses[] = {{"glass-BK7", 1.5168},  {"glass-BAF10", 1.67},  {"glass-FK51A", 1.4866},
                   {"glass-LASF9", 1.8503}, {"glass-F5", 1.6034},   {"glass-F10", 1.6229},
                   {"glass-F11", 1.6206},   {"glass-SF5", 1.6727},  {"glass-SF10", 1.7283},
                   {"glass-SF11", 1.7847}};
    bool good = true;
    const struct pbrt_param *a = pbrt_find(c, "float|spectrum", name, &good);
    *eta = a && a->numbers && strcmp(a->type, "float") == 0 ? a->numbers[0] : 1.5;
    if (a && a->texts) {
        for (size_t i = 0; i < sizeof glasses / sizeof *glasses; i++)
            if (strcmp(glasses[i].name, a->texts[0]) == 0) {
                *eta = glasses[i].eta;
                pbrt_warn(p, a->at, "\"%s\" has the index %g at all wavelengths", a->texts[0], *eta);
                return true;
            }
        log_error_at(a->at, "\"%s\" is not a glass that is known", a->texts[0]);
        return false;
    }
    if (a && strcmp(a->type, "spectrum") == 0)
        *eta = a->numbers[a->count > 1 ? 1 : 0]; // the first value of the pairs
    return good;
}

// ---- materials ----------------------------------------------------------------------------------

static bool diffuse(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    struct xml_node *base = opaque(p, c, out, "diffuse");
    return base && pbrt_put_texture(p, c, "reflectance", base, "reflectance", false);
}

static bool coateddiffuse(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    struct roughness r;
    double eta;
    if (!read_roughness(p, c, plain_roughness, &r) || !read_eta(p, c, "eta", &eta))
        return false;
    if (r.textured || r.u != r.v)
        pbrt_warn(p, c->at, "the roughness of a coat is one number: that of u");
    struct xml_node *base = opaque(p, c, out, r.smooth ? "plastic" : "roughplastic");
    if (!base)
        return false;
    tree_number(p->r, base, "int_ior", eta);
    tree_number(p->r, base, "ext_ior", 1);
    tree_text(p->r, base, "boolean", "nonlinear", "true");
    if (!r.smooth) {
        tree_text(p->r, base, "string", "distribution", "ggx");
        tree_number(p->r, base, "alpha", r.u);
    }
    return pbrt_put_texture(p, c, "reflectance", base, "diffuse_reflectance", false);
}

// "metal-Cu-eta" is of the material Cu.
static const char *metal_name(struct pbrt *p, const struct pbrt_param *a) {
    if (!a || !a->texts || strncmp(a->texts[0], "metal-", 6) != 0)
        return NULL;
    const char *name = a->texts[0] + 6, *end = strrchr(name, '-');
    return end ? arena_printf(p->r->arena, "%.*s", (int)(end - name), name) : NULL;
}

// eta 1 and the k that reflects so much at the normal.
static void put_reflectance(struct pbrt *p, const double r[3], struct xml_node *out) {
    static const double one[3] = {1, 1, 1};
    double k[3];
    for (int i = 0; i < 3; i++) {
        const double v = fmin(r[i], 0.9999);
        k[i] = 2 * sqrt(v) / sqrt(1 - v);
    }
    tree_triple(p->r, out, "rgb", "eta", one);
    tree_triple(p->r, out, "rgb", "k", k);
}

static bool put_metal(struct pbrt *p, struct pbrt_call *c, const char *eta_name,
                      const char *k_name, struct xml_node *out) {
    bool good = true;
    double v[3];
    if (pbrt_read_colour(p, c, "reflectance", PBRT_REFLECTANCE, v, &good)) {
        put_reflectance(p, v, out);
        return true;
    }
    const struct pbrt_param *eta = pbrt_find(c, "rgb|spectrum", eta_name, &good);
    const struct pbrt_param *k = pbrt_find(c, "rgb|spectrum", k_name, &good);
    const char *name = eta ? metal_name(p, eta) : "Cu";
    if (!good)
        return false;
    if (name || !eta || !k) {
        tree_text(p->r, out, "string", "material", name ? name : "Cu");
        return true;
    }
    if (!pbrt_read_colour(p, c, eta_name, PBRT_UNBOUNDED, v, &good))
        return false;
    tree_triple(p->r, out, "rgb", "eta", v);
    if (!pbrt_read_colour(p, c, k_name, PBRT_UNBOUNDED, v, &good))
        return false;
    tree_triple(p->r, out, "rgb", "k", v);
    return true;
}

static bool conductor(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    struct roughness r;
    if (!read_roughness(p, c, plain_roughness, &r))
        return false;
    struct xml_node *base = opaque(p, c, out, r.smooth ? "conductor" : "roughconductor");
    return base && put_metal(p, c, "eta", "k", base) && (r.smooth || put_roughness(p, c, plain_roughness, &r, base));
}

static void put_coat(struct pbrt *p, struct pbrt_call *c, const struct roughness *r, double eta,
                     struct xml_node *out) {
    if (r->textured || r->u != r->v)
        pbrt_warn(p, c->at, "the roughness of a coat is one number: that of u");
    pbrt_set_type(p, out, "coated");
    tree_number(p->r, out, "int_ior", eta);
    tree_number(p->r, out, "ext_ior", 1);
    if (!r->smooth)
        tree_number(p->r, out, "alpha", r->u);
}

// The metal meets the coat's index, not that of air.
static bool coatedconductor(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const coat_names[3] = {"interface.roughness", "interface.uroughness",
                                              "interface.vroughness"};
    static const char *const metal_names[3] = {"conductor.roughness", "conductor.uroughness",
                                               "conductor.vroughness"};
    struct roughness coat, metal;
    double eta;
    if (!read_roughness(p, c, coat_names, &coat) || !read_roughness(p, c, metal_names, &metal) ||
        !read_eta(p, c, "interface.eta", &eta))
        return false;
    struct xml_node *layers = perturbed(p, c, inside(p, c, out, "twosided"));
    if (!layers)
        return false;
    put_coat(p, c, &coat, eta, layers);
    struct xml_node *base = pbrt_add(p, layers, "bsdf", metal.smooth ? "conductor" : "roughconductor",
                                     NULL, c->at);
    tree_number(p->r, base, "ext_eta", eta);
    return put_metal(p, c, "conductor.eta", "conductor.k", base) &&
           (metal.smooth || put_roughness(p, c, metal_names, &metal, base));
}

static bool dielectric(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    struct roughness r;
    double eta;
    if (!read_roughness(p, c, plain_roughness, &r) || !read_eta(p, c, "eta", &eta))
        return false;
    struct xml_node *base = perturbed(p, c, out);
    if (!base)
        return false;
    pbrt_set_type(p, base, r.smooth ? "dielectric" : "roughdielectric");
    tree_number(p->r, base, "int_ior", eta);
    tree_number(p->r, base, "ext_ior", 1);
    return r.smooth || put_roughness(p, c, plain_roughness, &r, base);
}

static bool thindielectric(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    double eta;
    struct xml_node *base = read_eta(p, c, "eta", &eta) ? perturbed(p, c, out) : NULL;
    if (!base)
        return false;
    pbrt_set_type(p, base, "thindielectric");
    tree_number(p->r, base, "int_ior", eta);
    tree_number(p->r, base, "ext_ior", 1);
    return true;
}

static bool mix(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const struct pbrt_param *names = pbrt_find(c, "string", "materials", &good);
    if (!names || names->count != 2) {
        log_error_at(c->at, "a mix has two \"string materials\"");
        return false;
    }
    pbrt_set_type(p, out, "blendbsdf");
    for (int i = 0; i < 2; i++) {
        const char *id = arena_printf(p->r->arena, "material %s", names->texts[i]);
        if (!id_find(p->r, id)) {
            log_error_at(names->at, "there is no material \"%s\" before this line", names->texts[i]);
            return false;
        }
        pbrt_ref(p, out, NULL, id);
    }
    if (!pbrt_find(c, "texture|float", "amount", &good)) {
        tree_number(p->r, out, "weight", 0.5);
        return good;
    }
    return pbrt_put_texture(p, c, "amount", out, "weight", true);
}

static bool measured(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const char *name = pbrt_string(c, "filename", NULL, &good);
    if (!name) {
        log_error_at(c->at, "Material \"measured\": \"string filename\" is missing");
        return false;
    }
    struct xml_node *base = inside(p, c, out, "twosided");
    pbrt_set_type(p, base, "measured");
    tree_text(p->r, base, "string", "filename", name);
    return good;
}

static bool none(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    (void)c;
    pbrt_set_type(p, out, "null");
    return true;
}

// A sheet that scatters to both sides; what it lets through is a share of all that it scatters.
static bool diffusetransmission(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double r[3] = {0.25, 0.25, 0.25}, t[3] = {0.25, 0.25, 0.25}, sum[3], all = 0, through = 0;
    const double scale = pbrt_float(c, "scale", 1, &good);
    pbrt_read_colour(p, c, "reflectance", PBRT_REFLECTANCE, r, &good);
    pbrt_read_colour(p, c, "transmittance", PBRT_REFLECTANCE, t, &good);
    for (int i = 0; i < 3; i++) {
        sum[i] = fmin(scale * (r[i] + t[i]), 1);
        all += r[i] + t[i];
        through += t[i];
    }
    pbrt_warn(p, c->at, "diffusetransmission transmits the same share of all colours");
    pbrt_set_type(p, out, "principledthin");
    tree_triple(p->r, out, "rgb", "base_color", sum);
    tree_number(p->r, out, "diff_trans", all > 0 ? 2 * through / all : 0);
    tree_number(p->r, out, "eta", 1.0001); // no gloss
    return good;
}

const struct pbrt_row pbrt_materials[] = {
    {"diffuse", "diffuse, twosided", diffuse},
    {"coateddiffuse", "plastic or roughplastic, nonlinear, twosided; thickness and albedo of the "
     "coat: nothing", coateddiffuse},
    {"conductor", "conductor or roughconductor (ggx), twosided; alpha = sqrt(roughness) where it is "
     "remapped", conductor},
    {"coatedconductor", "coated over conductor or roughconductor, twosided; thickness and albedo of "
     "the coat, and what is reflected to and fro inside it: nothing", coatedconductor},
    {"dielectric", "dielectric or roughdielectric; named glasses have one index", dielectric},
    {"thindielectric", "thindielectric", thindielectric},
    {"diffusetransmission", "principledthin: diff_trans", diffusetransmission},
    {"mix", "blendbsdf", mix},
    {"measured", "measured", measured},
    {"interface", "null", none},
    {"", "null", none},
    {"subsurface", "refused", NULL},
    {"hair", "refused", NULL},
    {0},
};

bool pbrt_add_material(struct pbrt *p, struct pbrt_call *c, const char *id) {
    struct xml_node *out = pbrt_add(p, p->scene, "bsdf", NULL, id, c->at);
    return out && pbrt_make(p, pbrt_materials, c, out);
}
