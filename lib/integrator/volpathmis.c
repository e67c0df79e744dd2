// SPDX-License-Identifier: Apache-2.0
// Path tracing in media of coloured extinction: every lane's density is carried, and contributions
// are weighted against them all (Miller et al. 2019).
#include "integrator/volume_path.h"

static const struct param params[] = {
    VOLUME_PATH_PARAMS,
    {"use_spectral_mis", PARAM_BOOL, offsetof(struct volume_path, spectral), .def = "true",
     .unit = "", .help = "carry the density of every colour; false: as volpath"},
    PARAM_END,
};

const struct integrator_type integrator_volpathmis = {
    .entry = {.name = "volpathmis",
              .help = "volpath for coloured media: spectral MIS (Miller et al. 2019)",
              .params = params, .size = sizeof(struct volume_path)},
    .prepare = volume_path_prepare, .trace = volume_path_trace, .sees_media = true, .meters = true,
};
