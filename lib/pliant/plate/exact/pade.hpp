#pragma once

namespace pliant {

/// A complex number, without the library's checks for infinities.
struct Complex {
  double re = 0;
  double im = 0;

  friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex operator*(Complex a, double b) { return {a.re * b, a.im * b}; }
  friend bool operator==(Complex, Complex) = default;
};

/// Requires: a is not 0.
inline Complex reciprocal(Complex a) {
  const double square = a.re * a.re + a.im * a.im;
  return {a.re / square, -a.im / square};
}

/// One of the poles of the approximation R(z) of e^z, above the real axis; each has a conjugate.
struct Pole {
  Complex place;    ///< p
  Complex residue;  ///< r: R(z) is the sum of r/(z - p) over all poles
  Complex doubt;    ///< the same for G(z) - G(infinity)
};

/// R = P/Q is the quotient of degrees 7 and 8 that agrees with e^z best at 0, to z^15: one step of
/// the Radau IIA method of 8 stages. |R| < 1 wherever Re z < 0 and on the imaginary axis but for 0,
/// and R(infinity) = 0. G(z) = 8 c z^8/Q(z), with c such that G(infinity) = 8, is small where R is
/// good, and bounds 750 |R(iy) - e^(iy)| from y = 3 on. docs/model.md, eq. (8m) to (8o). Internal
/// to plate.
inline constexpr int pole_count = 4;
inline constexpr double doubt_at_infinity = 8;
inline constexpr Pole poles[pole_count] = {
    {{10.169446006657515100, 1.6492017968222276903},
     {2612.6208468682106611, -13549.060147438919676},
     {874.23561455364112432, -610.71726840327688817}},
    {{9.4063712136907400738, 4.9692172876232937654},
     {-3848.5444154374366244, 5690.3154338043130288},
     {-185.50613745534242909, -741.77526035246575910}},
    {{7.7386881468305480038, 8.3708793062379829598},
     {1334.8647374600172647, -702.43101049801378081},
     {-365.54488243209759791, -62.789521596867798523}},
    {{4.6854946328211968222, 12.010578599813790257},
     {-94.941168890791301424, -25.476662481767772734},
     {-67.184594666201097324, 74.997498631945939943}},
};

}  // namespace pliant
