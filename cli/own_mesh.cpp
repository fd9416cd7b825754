#include "own_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "rounded.hpp"

namespace pliant::cli {
namespace {

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end) {
    const double number = std::strtod(at, &end);
    if (end == at) return numbers;
    numbers.push_back(number);
  }
}

std::string text_of(const std::vector<double>& numbers) {
  std::vector<std::string> words;
  for (const double number : numbers) words.push_back(rounded(number));
  return fmt::format("{}", fmt::join(words, " "));
}

// A place, to a thousandth of the mesh's size.
std::string place_text(const Vector3d& at, double size) {
  const int digits = std::clamp(3 - static_cast<int>(std::floor(std::log10(size))), 0, 300);
  std::vector<std::string> words;
  for (const double number : at) {
    const std::string text = fmt::format("{:.{}f}", number, digits);
    words.push_back(fmt::format("{}", std::strtod(text.c_str(), nullptr) + 0.0));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

// Multiplies the numbers of an attribute, if the element has it.
void scale(EditedText& text, std::size_t element, std::string_view attribute, double factor) {
  const auto value = text.attribute(element, attribute);
  if (!value) return;
  std::vector<double> numbers = numbers_of(*value);
  for (double& number : numbers) number *= factor;
  text.set(element, attribute, text_of(numbers));
}

// Multiplies the values of the keys of a channel.
void scale_keys(EditedText& text, std::string_view channel, double factor) {
  for (auto animate = text.find("animate"); animate; animate = text.find("animate", *animate + 1)) {
    if (text.attribute(*animate, "attribute") != channel) continue;
    for (auto key = text.find("key", *animate); key && text.is_inside(*key, *animate);
         key = text.find("key", *key + 1)) {
      scale(text, *key, "value", factor);
    }
  }
}

// The vertex of the mesh that is nearest to the place that `point` has in the starter's box.
Vector3d same_place(const Vector3d& point, const StarterFacts& own, const StarterFacts& mesh) {
  const auto share = (point - own.low).cwiseQuotient(own.high - own.low);
  const Vector3d wanted = mesh.low + share.cwiseProduct(mesh.high - mesh.low);
  Eigen::Index nearest = 0;
  (mesh.vertices.rowwise() - wanted.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return mesh.vertices.row(nearest).transpose();
}

// Scales lengths, and moves each point force to the same place, with its direction inwards.
void place(EditedText& text, const StarterFacts& own, const StarterFacts& mesh) {
  const double size = mesh.diagonal() / own.diagonal();
  scale_keys(text, "translate", size);
  const auto force = text.find("point");
  if (!force) return;
  scale(text, *force, "deformationRadius", size);
  scale(text, *force, "forceRadius", size);
  const std::vector<double> center = numbers_of(text.attribute(*force, "center").value_or("0 0 0"));
  const Vector3d at = same_place({center[0], center[1], center[2]}, own, mesh);
  const Vector3d inwards = ((mesh.low + mesh.high) / 2 - at).normalized();
  text.set(*force, "center", place_text(at, mesh.diagonal()));
  text.set(*force, "direction", text_of({inwards.x(), inwards.y(), inwards.z()}));
}

}  // namespace

Result<StarterFacts> use_own_mesh(EditedText& text, const std::string& file,
                                  const StarterFacts& own, const StarterSource& source) {
  const std::size_t shape = *text.find("mesh");
  text.set(shape, "file", file);
  text.set(shape, "uv", "auto");
  const auto size = measure(text.text(), source);
  if (!size) return fail(size.error());
  place(text, own, *size);
  auto trial = look_at(text.text(), source);
  if (!trial) return trial;
  if (!trial->is_held) {
    return invalid(
        "nothing holds the mesh: it has no border; this starter needs one, such as the rim of a "
        "bowl");
  }
  const std::size_t material = *text.find("material");
  scale(text, material, "density", std::pow(trial->frequency / own.frequency, 2));
  const double wanted = own.peak * trial->diagonal() / own.diagonal();
  auto moved = look_at(text.text(), source);
  if (!moved || moved->is_by_inertia || !(moved->peak > 0)) return moved;
  scale_keys(text, "magnitude", wanted / moved->peak);
  StarterFacts facts = *moved;
  facts.peak = wanted;
  return facts;
}

}  // namespace pliant::cli
