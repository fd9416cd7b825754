#pragma once

#include <functional>

namespace pliant {

/// Called now and then during long work; true: the caller wants the work to end. Empty: never stop.
using StopRequest = std::function<bool()>;

}  // namespace pliant
