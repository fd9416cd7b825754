#pragma once

#include <functional>

namespace pliant {

/// Asked now and then during long work: true means that the caller wants it to end. Empty: never.
using StopRequest = std::function<bool()>;

}  // namespace pliant
