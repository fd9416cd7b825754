#include "pliant/plate/spectral/primes.hpp"

#include <set>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a prime has no divisors", "[plate][primes]") {
  for (long number = 2; number < 1000; ++number) {
    int divisors = 0;
    for (long k = 1; k <= number; ++k) divisors += number % k == 0;
    CAPTURE(number);
    CHECK(is_prime(number) == (divisors == 2));
  }
  CHECK(is_prime(2147483647));
  CHECK_FALSE(is_prime(46337L * 46337));
}

TEST_CASE("powers modulo a number are products one by one", "[plate][primes]") {
  for (const long modulus : {2L, 15L, 479L, 2147483647L}) {
    const long base = modulus - 2 + (modulus == 2);
    long product = 1;
    for (long exponent = 0; exponent < 100; ++exponent) {
      CAPTURE(modulus, exponent);
      CHECK(power_modulo(base, exponent, modulus) == product);
      product = product * base % modulus;
    }
  }
}

TEST_CASE("the powers of a primitive root are all residues but 0", "[plate][primes]") {
  for (long prime = 2; prime < 1000; ++prime) {
    if (!is_prime(prime)) continue;
    const long root = primitive_root(prime);
    std::set<long> powers;
    long power = 1;
    for (long k = 1; k < prime; ++k) {
      powers.insert(power);
      power = power * root % prime;
    }
    CAPTURE(prime, root);
    CHECK(power == 1);
    CHECK(static_cast<long>(powers.size()) == prime - 1);
    CHECK(powers.count(0) == 0);
  }
  CHECK(primitive_root(2147483647) == 7);  // a known value
}
