#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// 128 bits that nobody can guess, as 32 hexadecimal digits. Errors: Unreadable where the system
/// gives no random bytes.
Result<std::string> make_token();

/// Whether both are the same text. How long it takes tells nothing of where they differ, so that a
/// secret cannot be found out digit by digit; its length is no secret.
bool is_same_secret(std::string_view given, std::string_view secret);

}  // namespace pliant::cli
