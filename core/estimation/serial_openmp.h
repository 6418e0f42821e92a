// SPDX-License-Identifier: Apache-2.0
// CHOLMOD opens an OpenMP region of four threads for every supernode, whatever OMP_NUM_THREADS
// says. A pose graph has thousands of them, of 6 to 60 columns: waking and joining the threads
// takes three times as long as the arithmetic.
#ifndef OVERTONE_CORE_ESTIMATION_SERIAL_OPENMP_H_
#define OVERTONE_CORE_ESTIMATION_SERIAL_OPENMP_H_

// Of OpenMP's C interface. Not from omp.h, which belongs to a compiler and not to the runtime that
// CHOLMOD loads.
extern "C" {
int omp_get_max_active_levels(void);
void omp_set_max_active_levels(int levels);
}

namespace overtone {

// While it lives, OpenMP regions opened by this thread run on this thread alone.
class SerialOpenMp {
 public:
  SerialOpenMp() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~SerialOpenMp() { omp_set_max_active_levels(levels_); }
  SerialOpenMp(const SerialOpenMp&) = delete;
  SerialOpenMp& operator=(const SerialOpenMp&) = delete;

 private:
  const int levels_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_SERIAL_OPENMP_H_
