#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::viewer {

/// 128 random bits from the system, as 32 hexadecimal digits. Errors: Unreadable if the system
/// provides no random bytes.
Result<std::string> make_token();

/// Whether both texts are equal. The time needed does not depend on where they differ, so that a
/// secret cannot be found digit by digit; its length is not secret.
bool is_same_secret(std::string_view given, std::string_view secret);

}  // namespace pliant::viewer
