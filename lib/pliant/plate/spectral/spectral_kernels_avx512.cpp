#include "pliant/plate/spectral/spectral_kernels.hpp"

#define PLIANT_LANES 8
#define PLIANT_KERNELS avx512
#define PLIANT_KERNELS_NAME "avx512"
#include "pliant/plate/spectral/sine_transform_lanes.hpp"
#include "pliant/plate/spectral/spectral_fields_lanes.hpp"
#include "pliant/plate/spectral/spectral_kernels_lanes.hpp"
