// SPDX-License-Identifier: Apache-2.0
// Rows of option tables that subcommands which read a scene share: how to read it, and with what to
// render it. `member` of the struct `owner` takes what is given.
#pragma once

#include "base/options.h"

// struct option_list; bool
#define OPTION_DEFINE(owner, member)                                                              \
    {.name = "define", .letter = 'D', .type = OPTION_TEXTS, .offset = offsetof(owner, member),    \
     .argument = "NAME=VALUE", .help = "value of a scene parameter $NAME"}
#define OPTION_LENIENT(owner, member)                                                             \
    {.name = "lenient", .type = OPTION_FLAG, .offset = offsetof(owner, member),                   \
     .help = "unknown scene parameters warn instead of failing"}
// int[2], int[4]
#define OPTION_SIZE(owner, member)                                                                \
    {.name = "size", .type = OPTION_INTS, .values = 2, .offset = offsetof(owner, member),         \
     .argument = "WxH", .min = 1, .max = 65536,                                                    \
     .help = "size of the picture in place of the scene's"}
#define OPTION_CROP(owner, member)                                                                \
    {.name = "crop", .type = OPTION_RECTANGLE, .offset = offsetof(owner, member),                 \
     .argument = "X0,Y0,X1,Y1", .min = 0, .max = 65536,                                            \
     .help = "these pixels only; X1 and Y1 are just past the last"}
// struct receiver: two rows
#define OPTION_RECEIVER(owner, member)                                                            \
    {.name = "texels", .type = OPTION_TEXT, .offset = offsetof(owner, member.texels),             \
     .argument = "SHAPE",                                                                          \
     .help = "irradiance on the texels of a mesh in place of the camera's picture"},               \
    {.name = "vertices", .type = OPTION_TEXT, .offset = offsetof(owner, member.vertices),         \
     .argument = "SHAPE", .help = "irradiance at the vertices of a mesh, 256 to a row"}
// const char *
#define OPTION_INTEGRATOR(owner, member)                                                          \
    {.name = "integrator", .type = OPTION_TEXT, .offset = offsetof(owner, member),                \
     .argument = "NAME", .help = "integrator in place of the scene's"}
#define OPTION_SAMPLER(owner, member)                                                             \
    {.name = "sampler", .type = OPTION_TEXT, .offset = offsetof(owner, member),                   \
     .argument = "NAME", .help = "sampler in place of the scene's"}
// int
#define OPTION_MAX_DEPTH(owner, member)                                                           \
    {.name = "max-depth", .type = OPTION_INT, .offset = offsetof(owner, member),                  \
     .argument = "N", .min = -1, .max = 1000000, .def = "0",                                       \
     .help = "most edges of a path: 1 emitters, 2 direct light; -1: no limit,\n"                   \
             "0: as the scene says"}
#define OPTION_SEED(owner, member)                                                                \
    {.name = "seed", .type = OPTION_INT, .offset = offsetof(owner, member), .argument = "N",      \
     .min = 0, .max = 2147483647, .def = "0", .help = "another seed gives independent noise"}
