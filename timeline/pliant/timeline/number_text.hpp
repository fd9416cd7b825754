#pragma once

#include <string>

namespace pliant::timeline {

/// The shortest text that parses to the same number: "0.1", "1e+300", "nan".
std::string number_text(double number);

}  // namespace pliant::timeline
