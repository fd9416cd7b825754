// Edits of a curve. Each takes a curve and returns a new one.

#include <cstdio>

#include <pliant/timeline/edit/edit.hpp>
#include <pliant/timeline/edit/simplify.hpp>

namespace {

void print(const char* what, const pliant::Curve<1>& curve) {
  std::printf("%-28s %zu keys:", what, curve.keys().keys.size());
  for (double frame = 1; frame <= 25; frame += 4) std::printf(" %7.3f", curve.value(frame)[0]);
  std::printf("\n");
}

int tell(const pliant::Complaint& error) {
  std::fprintf(stderr, "key %zu: %s\n", error.index, error.message.c_str());
  return 2;
}

}  // namespace

int main() {
  using pliant::Curve;
  const auto swell = Curve<1>::make(
      {.keys = {
           {.frame = 1, .value = {0}}, {.frame = 9, .value = {5}}, {.frame = 25, .value = {1}}}});
  if (!swell) return tell(swell.error());
  print("a curve", *swell);

  // The same curve with one more key: every value stays.
  const auto finer = pliant::insert_key(*swell, 15.0);
  if (!finer) return tell(finer.error());
  print("with a key at frame 15", *finer);

  // Twice as high, half as long, about frame 1 and value 0.
  const auto shorter = pliant::scale(
      *swell, pliant::Scaling<1>{.frame = 1, .time_factor = 0.5, .value_factor = {2}});
  if (!shorter) return tell(shorter.error());
  print("half as long, twice as high", *shorter);

  const auto backwards = pliant::reverse(*swell, 13.0);
  if (!backwards) return tell(backwards.error());
  print("backwards", *backwards);

  // Fewer keys with a bound for the deviation at every frame, not only at samples.
  const auto simpler = pliant::simplify(*finer, 1, 25, 0.05);
  if (!simpler) return tell(simpler.error());
  std::printf("simplified: %zu keys, within %.3g\n", simpler->keys.keys.size(), simpler->error);
}
