// SPDX-License-Identifier: Apache-2.0
// What `relume brdf` tells, converts and draws of a material.
#pragma once

#include "base/json.h"
#include "driver/material.h"

// Directional and hemispherical albedos, errors of reciprocity and energy, lobes. Albedos are means
// of sampled weights (the standard error comes with them), delta lobes included; reciprocity is that
// of the other lobes over pairs of directions above the surface.
void brdf_report(const struct material *m, struct json *out);

// By the extension of the path: .binary (MERL), .transfer; .json (its form, for
// the parameter `edited`; of a material that is not editable, fitted factors) or .csv (a table a
// curve, OUT-TERM-SLOT.csv). Delta
// lobes have no value and are left out with a warning. false after an error message.
bool brdf_convert(const struct material *m, const char *path);
// Whether that path wants the material's curves.
bool brdf_wants_curves(const char *path);
bool brdf_write_curves(const struct material *m, const char *path); // brdf_convert's part
// The values of a MERL table (table/merl.h), -1 where nothing is seen; free with mem_free. Says what
// such a table cannot hold.
float (*brdf_merl_values(const struct material *m, const char *path))[3];

enum brdf_plot { BRDF_PLOT_CUT, BRDF_PLOT_LOBE, BRDF_PLOT_CURVE };
extern const char *const brdf_plot_names[];

// Draws into .svg or .png, seen from those angles (degrees). false after an error message.
//   cut    f cos_i in the plane of incidence, polar, its cube root as radius
//   lobe   the same over all directions, as a net in parallel projection
//   curve  f against theta_h at theta_d = 0, logarithmic, a line a channel
bool brdf_draw(const struct material *m, enum brdf_plot plot, const double *degrees, int count,
               const char *path);
