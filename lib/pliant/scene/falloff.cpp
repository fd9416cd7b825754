#include "pliant/scene/falloff.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/keys.hpp"

namespace pliant::xml {

std::optional<Curve<1>> read_falloff(const tinyxml2::XMLElement& falloff, const std::string& owner,
                                     Findings& findings) {
  return read_curve<1>(falloff, KeyAxis::Falloff, ValueKind::Number, owner + ".falloff", findings);
}

void check_single_falloff(const tinyxml2::XMLElement& falloff, const Slot& attribute,
                          int& first_line, Findings& findings) {
  const int line = falloff.GetLineNum();
  const std::string parent = tag(*falloff.Parent()->ToElement());
  if (first_line != 0)
    findings.add_problem(line, fmt::format("{} has a second <falloff>; the first is at line {}",
                                           parent, first_line));
  else if (attribute.line != 0)
    findings.add_problem(
        line, fmt::format(
                  "{} has both a <falloff> and the attribute falloff (line {}); remove one of them",
                  parent, attribute.line));
  if (first_line == 0) first_line = line;
}

}  // namespace pliant::xml
