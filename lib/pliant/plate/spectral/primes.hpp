#pragma once

namespace pliant {

// Residues of a prime, for the sine transform. Internal to plate.

/// Whether a number is prime. O(sqrt(number)). Requires: number >= 2.
bool is_prime(long number);

/// base^exponent modulo a number below 2^31. Requires: 0 <= base < modulus, exponent >= 0.
long power_modulo(long base, long exponent, long modulus);

/// The least number whose powers modulo a prime are all of 1 ... prime - 1. Requires: prime < 2^31.
long primitive_root(long prime);

}  // namespace pliant
