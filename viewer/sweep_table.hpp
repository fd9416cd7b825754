#pragma once

#include <cstddef>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/sweep/folder.hpp"
#include "viewer/arrays.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// Some of `count` numbers from 0, evenly spread, with both ends; all if they are no more than
/// `most`.
std::vector<std::size_t> evenly_spread(std::size_t count, std::size_t most);

/// The takes whose rows a page has: all, or as many as fit into 13 MB, before they are packed,
/// evenly spread, and those of `needed`. Any, if it is stopped.
std::vector<std::size_t> table_rows(const SweepFolder& folder, const SweepStatus& status,
                                    const std::vector<std::size_t>& needed,
                                    const StopRequest& should_stop = {});

/// The rows of some takes for a page; docs/viewer.md. Without some texts, if it is stopped.
Json table_json(const SweepFolder& folder, const SweepStatus& status,
                const std::vector<std::size_t>& rows, Arrays& arrays,
                const StopRequest& should_stop = {});

}  // namespace pliant::viewer
