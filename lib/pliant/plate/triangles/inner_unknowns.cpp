#include "pliant/plate/triangles/inner_unknowns.hpp"

namespace pliant {

InnerUnknowns::InnerUnknowns(const TriangleCells& cells, const ReducedUnknowns& reduced,
                             const Bending& bending, const CellFactors* factors, StopPoll& poll)
    : places_(reduced.places), left_(reduced.count) {
  CellBlock<double> block;
  for (const int number : reduced.blocks) {
    block.compute(cells, number, reduced, bending, factors);
    if (poll.after(32 * static_cast<std::size_t>(block.size() * block.size()))) return;
    blocks_.push_back({unknowns_.size(), factors_.size(), block.inner_count(), block.size()});
    for (int k = 0; k < block.size(); ++k) unknowns_.push_back(block.unknown(k));
    for (int p = 0; p < block.inner_count(); ++p) {
      factors_.push_back(block.at(p, p));
      for (int k = p + 1; k < block.size(); ++k)
        factors_.push_back(block.at(p, k) / block.at(p, p));
    }
  }
}

Field InnerUnknowns::eliminate(Field& forces) const {
  for (const Block& block : blocks_) {
    const int* const unknowns = unknowns_.data() + block.unknown;
    for (int component = 0; component < 3; ++component) {
      double* const on = forces.col(component).data();
      const double* factor = factors_.data() + block.factor;
      for (int p = 0; p < block.inner; ++p) {
        const double force = on[unknowns[p]];
        on[unknowns[p]] = force / *factor++;
        if (force == 0) {
          factor += block.size - p - 1;
          continue;
        }
        for (int k = p + 1; k < block.size; ++k) on[unknowns[k]] -= *factor++ * force;
      }
    }
  }
  Field left(left_, 3);
  for (int unknown = 0; unknown < static_cast<int>(places_.size()); ++unknown) {
    if (places_[unknown] >= 0) left.row(places_[unknown]) = forces.row(unknown);
  }
  return left;
}

Field InnerUnknowns::recovered(const Field& left, const Field& eliminated) const {
  Field all = eliminated;
  for (int unknown = 0; unknown < static_cast<int>(places_.size()); ++unknown) {
    if (places_[unknown] >= 0) all.row(unknown) = left.row(places_[unknown]);
  }
  for (const Block& block : blocks_) {
    const int* const unknowns = unknowns_.data() + block.unknown;
    for (int component = 0; component < 3; ++component) {
      double* const at = all.col(component).data();
      // The factors of inner unknown p begin after those of the ones before it.
      std::size_t first = block.factor + static_cast<std::size_t>(block.inner) * block.size -
                          static_cast<std::size_t>(block.inner) * (block.inner - 1) / 2;
      for (int p = block.inner - 1; p >= 0; --p) {
        first -= static_cast<std::size_t>(block.size - p);
        for (int k = p + 1; k < block.size; ++k)
          at[unknowns[p]] -= factors_[first + (k - p)] * at[unknowns[k]];
      }
    }
  }
  return all;
}

std::size_t InnerUnknowns::memory() const {
  return (places_.size() + unknowns_.size()) * sizeof(int) + blocks_.size() * sizeof(Block) +
         factors_.size() * sizeof(double);
}

}  // namespace pliant
