// SPDX-License-Identifier: Apache-2.0
// What a search for the cheapest storage works on.
#pragma once

#include "replay/budget.h"
#include "replay/trial.h"

struct budget_block {
    struct tensor_block from;  // without rows
    float *unpacked[2];
    uint32_t *order;           // by new lane, the old one; lanes beyond the end repeat the last
    uint32_t *pixels;
    float *view;               // or NULL
    float *factor;             // f_o by new lane, [tile][channel][lane], or NULL
    uint8_t *ways[2];          // of values and halves, [tile][coefficient]
    float *costs;              // of each way, [tile][coefficient][way]
};

struct budget {
    const struct tensor *tensor;
    const struct budget_options *options;
    struct budget_block *blocks;
    float **weights[TRIALS]; // [block][coefficient][channel], over the mean of the picture
    float *picture[TRIALS];  // 3 planes
    double unit[TRIALS];     // 1 / mean
    float *loss[TRIALS];     // what a squared error of a pixel's channel, over the mean, adds to relMSE
    struct arena arena;
};

// A coefficient of a new tile. Whether any of it is not zero.
bool budget_gather(const struct budget_block *b, bool halves, size_t tile, uint32_t coefficient,
                   float row[ROW_VALUES]);

// Adds up, for each trial, coefficients times weights; of `errors` what rows in their ways differ by.
void budget_pictures(struct budget *b, bool halves, bool errors, float *const out[TRIALS]);

// Costs of all ways for all rows.
void budget_costs(struct budget *b, bool halves);

// Lists in Z order.
void budget_order(struct budget_block *b, uint32_t width, struct arena *arena);
