#include "pliant/plate/spectral/primes.hpp"

#include <algorithm>
#include <vector>

#include "pliant/core/expects.hpp"

namespace pliant {

bool is_prime(long number) {
  PLIANT_EXPECTS(number >= 2);
  for (long factor = 2; factor * factor <= number; ++factor) {
    if (number % factor == 0) return false;
  }
  return true;
}

long power_modulo(long base, long exponent, long modulus) {
  long result = 1;
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) result = result * base % modulus;
    base = base * base % modulus;
  }
  return result;
}

long primitive_root(long prime) {
  PLIANT_EXPECTS(is_prime(prime));
  // The order of a primitive root is prime - 1 itself, so it divides none of the largest proper
  // divisors of prime - 1.
  std::vector<long> largest;
  long rest = prime - 1;
  for (long factor = 2; rest > 1; ++factor) {
    if (factor * factor > rest) factor = rest;
    if (rest % factor != 0) continue;
    largest.push_back((prime - 1) / factor);
    while (rest % factor == 0) rest /= factor;
  }
  for (long root = 1;; ++root) {
    if (std::none_of(largest.begin(), largest.end(),
                     [&](long order) { return power_modulo(root, order, prime) == 1; })) {
      return root;
    }
  }
}

}  // namespace pliant
