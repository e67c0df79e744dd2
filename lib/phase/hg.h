// SPDX-License-Identifier: Apache-2.0
#pragma once

// Instance data of the Henyey-Greenstein phase function.
struct hg {
    float g; // mean cosine of the deflection
};
