// SPDX-License-Identifier: Apache-2.0
// Path tracing in media: delta tracking under local majorants, ratio tracking towards lights.
#include "integrator/volume_path.h"

static const struct param params[] = {VOLUME_PATH_PARAMS, PARAM_END};

const struct integrator_type integrator_volpath = {
    .entry = {.name = "volpath",
              .help = "path tracing with participating media (Novak et al. 2014; Kutz et al. 2017)",
              .params = params, .size = sizeof(struct volume_path)},
    .prepare = volume_path_prepare, .trace = volume_path_trace, .sees_media = true, .meters = true,
};
