#include "pliant/timeline/channel.hpp"

#include <utility>

namespace pliant {

template <int D>
Channel<D>::Channel(Value<D> constant) : constant_(constant) {}

template <int D>
Channel<D>::Channel(Curve<D> curve) : curve_(std::move(curve)) {}

template <int D>
Channel<D>::Channel(const Channel&) = default;

template <int D>
Channel<D>::Channel(Channel&&) noexcept = default;

template <int D>
Channel<D>& Channel<D>::operator=(const Channel&) = default;

template <int D>
Channel<D>& Channel<D>::operator=(Channel&&) noexcept = default;

template <int D>
Channel<D>::~Channel() = default;

template <int D>
void Channel<D>::adjust(const Adjustments<D>& adjustments) {
  if (curve_) {
    curve_ = curve_->adjusted(adjustments);
  } else {
    constant_ = adjusted_value<D>(adjustments, constant_);
  }
}

template class Channel<1>;
template class Channel<3>;

}  // namespace pliant
