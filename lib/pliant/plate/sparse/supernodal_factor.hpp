#pragma once

#include <memory>

#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// Factors by supernodes, from the leaves of their tree to its root: each gathers what those below
/// it leave for its rows in one dense matrix, its front, eliminates its columns, and leaves the
/// rest to its parent. The same bits for every width of vectors and number of threads. Internal to
/// plate. Source: Liu, "The multifrontal method for sparse matrix solution: theory and practice"
/// (1992).
std::unique_ptr<SparseFactor> make_supernodal_factor(const RunContext& context);

}  // namespace pliant
