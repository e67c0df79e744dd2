// SPDX-License-Identifier: Apache-2.0
// Closures and preparations that smooth materials share with their rough counterparts, which
// become them where the roughness vanishes.
#pragma once

#include "bsdf/bsdf.h"
#include "math/ior.h"

// Index parameters of a conductor, as a member of its data.
struct conductor_index {
    const char *material; // NULL: eta and k as given
    spectrum eta, k;
    float ext_eta;        // index outside; Mitsuba 0.5/0.6 has it, 3 does not
};

#define CONDUCTOR_INDEX_PARAMS(type, m)                                                            \
    {"material", PARAM_STRING, offsetof(type, m.material), .unit = "", .optional = true,          \
     .help = "name of a metal (Au, Cu, Al, ...), or none: reflects everything"},                   \
    {"eta", PARAM_INDEX, offsetof(type, m.eta), .def = "0", .max = 1e4, .unit = "",               \
     .help = "real part of the index of refraction"},                                              \
    {"k", PARAM_INDEX, offsetof(type, m.k), .def = "1", .max = 1e4, .unit = "",                   \
     .help = "imaginary part of the index of refraction"},                                         \
    {"ext_eta", PARAM_IOR, offsetof(type, m.ext_eta), .def = "1", .min = IOR_LEAST,             \
     .max = IOR_MOST, .unit = "", .help = "index of refraction outside"}

// Looks the material up and divides by the index outside. false after an error message.
bool conductor_index_prepare(struct conductor_index *index, const struct object *self);

// wo above the surface.
const struct closure *conductor_closure(spectrum eta, spectrum k, spectrum reflectance, vec3 wo,
                                        struct closure_stack *stack);

// Index parameters of a dielectric boundary.
struct dielectric_index {
    float int_ior, ext_ior;
};

#define DIELECTRIC_INDEX_PARAMS(type, m, interior)                                                 \
    {"int_ior", PARAM_IOR, offsetof(type, m.int_ior), .def = interior, .min = IOR_LEAST,        \
     .max = IOR_MOST, .unit = "", .help = "index of refraction inside, or a material's name"},                      \
    {"ext_ior", PARAM_IOR, offsetof(type, m.ext_ior), .def = "air", .min = IOR_LEAST,           \
     .max = IOR_MOST, .unit = "", .help = "index of refraction outside, or a material's name"}

// wo on either side; eta is the index inside over the one outside. With eta = 1 nothing is there:
// a closure of LOBE_NULL alone.
const struct closure *dielectric_closure(float eta, spectrum reflectance, spectrum transmittance,
                                         vec3 wo, struct closure_stack *stack);
uint32_t dielectric_lobes(float eta);

// The reflecting coat of plastic over a diffuse base, wo above. What leaves is kept, not what is
// reflected inside: at large indices that is 1 to rounding.
struct plastic_coat {
    float eta;
    float entering; // transmitted of diffuse light from outside
    float leaving;  // and from inside
    bool nonlinear;
};

const struct closure *plastic_closure(const struct plastic_coat *coat, spectrum diffuse,
                                      spectrum specular, vec3 wo, struct closure_stack *stack);

// Reflectance of the base as seen through the coat, without the two crossings' transmittances:
// diffuse / (1 - a (1 - leaving)) / eta^2, where light reflected back inside meets the base again
// and keeps the share a of itself.
static inline spectrum plastic_base(spectrum diffuse, const struct plastic_coat *coat) {
    const spectrum a = coat->nonlinear ? diffuse : spectrum_grey(1);
    const spectrum loss = (spectrum_grey(1) - a) + a * coat->leaving;
    return spectrum_divide(diffuse, loss) / (coat->eta * coat->eta);
}
