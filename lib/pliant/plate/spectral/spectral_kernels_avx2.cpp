#include "pliant/plate/spectral/spectral_kernels.hpp"

#define PLIANT_LANES 4
#define PLIANT_KERNELS avx2
#define PLIANT_KERNELS_NAME "avx2"
#include "pliant/plate/spectral/sine_transform_lanes.hpp"
#include "pliant/plate/spectral/spectral_fields_lanes.hpp"
#include "pliant/plate/spectral/spectral_kernels_lanes.hpp"
