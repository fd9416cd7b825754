#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The numbers of a .npy of `rows` x `columns`, row by row: of a grid's nodes, in their order.
/// `name` is the file's name in messages. Errors, naming it: those of `read_npy_header`; another
/// shape; fewer numbers than it promises; one that is not finite; Interrupted.
Result<std::vector<double>> parse_npy_grid(std::string_view bytes, const std::string& name,
                                           int columns, int rows,
                                           const StopRequest& should_stop = {});

}  // namespace pliant
