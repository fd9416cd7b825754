#include "pliant/scene/reading/net.hpp"

#include <utility>

#include <fmt/format.h>

namespace pliant::xml {

void NetReader::read_content(const Element& element) {
  const Child children[] = {
      {"points", [&](const Element& child) { read_points(child); }},
      {"weights",
       [&](const Element& child) {
         Table none;
         read_attributes(child, none, file_.findings);
         read_part(child, "weights", net_.weights);
       }},
      {"knots", [&](const Element& child) { read_knots(child); }},
  };
  const bool all_known = read_children(element, children, file_.findings);
  if (lines_.contains("points")) return;
  unsound_.emplace_back("points");
  if (all_known)
    file_.findings.add_problem(element.line(),
                               fmt::format("{} needs the element <points>", tag(element)));
}

/// Whether the part is sound, and not there already.
bool NetReader::read_part(const Element& element, const std::string& part,
                          std::vector<double>& numbers) {
  const auto [first, is_new] = lines_.emplace(part, element.line());
  std::vector<double> read;
  bool is_sound = read_numbers(element, read, file_.findings);
  if (is_sound && read.empty()) {
    is_sound = false;
    file_.findings.add_problem(element.line(), fmt::format("{} has no numbers", tag(element)));
  }
  if (!is_new)
    file_.findings.add_problem(
        element.line(), fmt::format("<nurbs> has a second {}; the first is at {}", tag(element),
                                    file_.findings.title_of(first->second, element.line())));
  if (!is_sound || !is_new) {
    unsound_.push_back(part);
    return false;
  }
  numbers = std::move(read);
  return true;
}

void NetReader::read_points(const Element& element) {
  Table none;
  read_attributes(element, none, file_.findings);
  std::vector<double> numbers;
  if (!read_part(element, "points", numbers)) return;
  if (numbers.size() % 3 != 0) {
    unsound_.emplace_back("points");
    return file_.findings.add_problem(
        element.line(),
        fmt::format("{} has {} numbers; each point has three", tag(element), numbers.size()));
  }
  const auto count = static_cast<Eigen::Index>(numbers.size() / 3);
  net_.points = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
      numbers.data(), count, 3);
}

void NetReader::read_knots(const Element& element) {
  KnotsText knots;
  Table table = table_of(knots);
  read_attributes(element, table, file_.findings);
  if (!knots.along) {  // its problem is found already
    unsound_.emplace_back("knotsU");
    unsound_.emplace_back("knotsV");
    return;
  }
  if (*knots.along == Along::U)
    read_part(element, "knotsU", net_.u.knots);
  else
    read_part(element, "knotsV", net_.v.knots);
}

void NetReader::record_content() {
  for (const auto& [part, line] : lines_) file_.lines[fmt::format("{}.{}", surface_, part)] = line;
  for (const std::string& part : unsound_)
    file_.unsound.insert(fmt::format("{}.{}", surface_, part));
}

}  // namespace pliant::xml
