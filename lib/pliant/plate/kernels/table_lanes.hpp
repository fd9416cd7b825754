// The table of the kernels: their last part. No #pragma once, no other header: see kernels.hpp.

namespace pliant {

#define PLIANT_JOIN_(a, b) a##b
#define PLIANT_JOIN(a, b) PLIANT_JOIN_(a, b)

const PlateKernels PLIANT_JOIN(PLIANT_KERNELS, _kernels) = {PLIANT_KERNELS_NAME,
                                                            lanes,
                                                            sine_transform,
                                                            sine_transform_pair,
                                                            in_across,
                                                            in_along,
                                                            out_along,
                                                            out_across,
                                                            start,
                                                            solve_at_rest,
                                                            step,
                                                            last_step,
                                                            reflected_start,
                                                            reflected_step,
                                                            last_reflected_step,
                                                            invert_edge,
                                                            prepare_shift,
                                                            find_lack,
                                                            exact_step,
                                                            exact_size,
                                                            flow_curvatures,
                                                            flow,
                                                            flow_along,
                                                            add_squared_stress,
                                                            dot_product,
                                                            combine,
                                                            add_scaled,
                                                            longest,
                                                            factor_kernels<RealNumbers>,
                                                            factor_kernels<ComplexNumbers>};

}  // namespace pliant
