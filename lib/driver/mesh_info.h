// SPDX-License-Identifier: Apache-2.0
// What a mesh file holds, for `relume info`.
#pragma once

#include <stdbool.h>

#include "base/json.h"

// Reads every mesh of the file and adds what it holds to a JSON object; of several their sums and,
// unless they are more than `most_rows`, a row for each. false after an error message.
bool mesh_info_add(const char *path, int most_rows, struct json *out);
