// SPDX-License-Identifier: Apache-2.0
// Storing an edit tensor as cheaply as an error in its pictures allows.
//
// Each row (transport/rows.h) gets the way that is cheapest in bytes + price * error. A row's error
// is what its rounding adds to relMSE, the largest of some trials (replay/trial.h), as if roundings
// were independent. They are not where rows are dropped or averaged, so the price is found by
// bisection on pictures: the largest relMSE of the trials' pictures against those of the tensor as it
// was is within the budget, and stands in the metadata, "storage relmse"; edits far from all trials may
// exceed it. The tensor's own noise has no part in that. Halves get a budget of their own, a share of the noise they tell of.
//
// Lists of pixels are brought to Z order, so that four lanes are neighbours.
#pragma once

#include "transport/tensor.h"

struct budget_options {
    double relmse;
    int threads;
    bool no_halves; // are not kept
    const char *command;
};

struct budget_report {
    uint64_t bytes, value_bytes, float_bytes; // blocks; without halves; as float32 without halves
    uint64_t nonzero;            // coefficients of a pixel, of all channels, that are not zero
    uint64_t rows[ROW_WAYS];     // of the values
    double relmse[4];            // of each trial
    double worst;                // of them
    double rgbe;                 // the largest if all rows were stored as RGBE
    double noise;                // the tensor's own, by its halves, of the picture as it is
    double noise_change;         // of the noise told, relative
};

// false after an error message.
bool budget_store(const char *path, const char *output, const struct budget_options *o,
                  struct budget_report *report);

// The picture of a trial that the tensor would give if it were stored so, three planes; nothing is
// written. A budget of 0: the tensor as it is. Of the report: value_bytes, relmse and worst. false
// after an error message: also if the tensor is of another size.
bool budget_picture(const char *path, const struct budget_options *o, int trial, int width, int height,
                    float *frame, struct budget_report *report);
