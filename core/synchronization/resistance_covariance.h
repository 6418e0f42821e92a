// SPDX-License-Identifier: Apache-2.0
// How well a map knows where one of its poses is seen from another, without the joint marginals of
// all poses: by effective resistance on the graph of its measurements, weighted by their
// information.
//
// Each edge measures a relative pose with error [rho; phi] of covariance diag(s_t^2 I, s_r^2 I) at
// its second end b. Seen from pose j, with P = [p]^x and p where b lies there, the same error is
//     C_e = [ s_t^2 I + s_r^2 P P^T   s_r^2 P ]
//           [ s_r^2 P^T               s_r^2 I ].
// Any flow of 1 from i to j along the edges, whatever its matrix shares F_e, gives an unbiased
// estimate of the relative pose, of covariance sum F_e C_e F_e^T; the least of all is the joint
// marginal (Gauss-Markov, for resistances Thomson's principle). We take the currents f_t, f_r of
// two scalar networks, of conductance 1 / s_t^2 and 1 / s_r^2:
//     F_e = diag(f_t I, f_r I),
//     covariance = [ R_t I + sum f_t^2 s_r^2 P P^T   sum f_t f_r s_r^2 P ]
//                  [ ...                             R_r I               ],
// R_t and R_r being effective resistances. So
//   - on a chain, where there is one flow only, it is exact;
//   - with loops it is never below the joint marginal: a loop's positions also tell of headings, of
//     which two networks know nothing;
//   - Kron reduction leaves R_t and R_r as they are, but not the lever term, which takes a reduced
//     edge's error to arise at its second end: with edges of length l along a chain, levers of up
//     to p are off by l, and the variance by at most R_r (2 p l + l^2).
// Limits: errors small enough to be linear; covariances of edges that are not isotropic go in by
// their means over the axes.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_RESISTANCE_COVARIANCE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_RESISTANCE_COVARIANCE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/spectral/effective_resistance.h"

namespace overtone {

struct InformationEdge {
  int first = 0;  // positions among the poses, different
  int second = 0;
  double translation = 0;  // 1 / m^2, per axis; positive
  double rotation = 0;     // 1 / rad^2, per axis; positive
};

class ResistanceCovariance {
 public:
  // poses: map_from_body. InvalidArgument naming the edge that is none, or whose information is not
  // finite and positive.
  static absl::StatusOr<ResistanceCovariance> Create(const std::vector<Rigid3d>& poses,
                                                     const std::vector<InformationEdge>& edges);

  // Right tangent of from_tform_to. FailedPrecondition: no path joins them.
  absl::StatusOr<Matrix6d> Covariance(int from, int to) const;

  const EffectiveResistance& translation() const { return translation_; }  // m^2
  const EffectiveResistance& rotation() const { return rotation_; }        // rad^2

 private:
  ResistanceCovariance(const std::vector<Rigid3d>& poses, const std::vector<InformationEdge>& edges,
                       EffectiveResistance translation, EffectiveResistance rotation);

  std::vector<Rigid3d> poses_;
  std::vector<InformationEdge> edges_;
  EffectiveResistance translation_, rotation_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_RESISTANCE_COVARIANCE_H_
