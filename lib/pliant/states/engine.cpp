#include "pliant/states/engine.hpp"

#include "engine_digest.hpp"  // made by cmake/EngineDigest.cmake

namespace pliant {

std::string_view engine_name() { return PLIANT_ENGINE_DIGEST; }

}  // namespace pliant
