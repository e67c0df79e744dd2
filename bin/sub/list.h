// SPDX-License-Identifier: Apache-2.0
// The subcommands, in the order in which --help lists them: one X(name) line each.
X(render)
X(measure)
X(precompute)
X(relight)
X(edit)
X(merge)
X(compare)
X(tonemap)
X(study)
X(info)
X(brdf)
X(help)
