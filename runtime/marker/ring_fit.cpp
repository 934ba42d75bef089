#include "runtime/marker/ring_fit.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {
namespace {

using Matrix = std::array<std::array<double, kMaxParameters>, kMaxParameters>;
using Vector = std::array<double, kMaxParameters>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Lower Cholesky factor in place, n x n. False if not positive definite.
bool factorize(Matrix& A, int n) {
  for (int j = 0; j < n; ++j) {
    double pivot = A[at(j)][at(j)];
    for (int k = 0; k < j; ++k) pivot -= A[at(j)][at(k)] * A[at(j)][at(k)];
    if (!(pivot > 1e-12)) return false;  // the matrix is scaled to a unit diagonal
    const double root = std::sqrt(pivot);
    A[at(j)][at(j)] = root;
    for (int i = j + 1; i < n; ++i) {
      double sum = A[at(i)][at(j)];
      for (int k = 0; k < j; ++k) sum -= A[at(i)][at(k)] * A[at(j)][at(k)];
      A[at(i)][at(j)] = sum / root;
    }
  }
  return true;
}

// @param first  b is zero before it.
void substitute(const Matrix& L, int n, Vector& b, int first = 0) {
  for (int i = first; i < n; ++i) {
    for (int k = first; k < i; ++k) b[at(i)] -= L[at(i)][at(k)] * b[at(k)];
    b[at(i)] /= L[at(i)][at(i)];
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) b[at(i)] -= L[at(k)][at(i)] * b[at(k)];
    b[at(i)] /= L[at(i)][at(i)];
  }
}

// Scales H to a unit diagonal (plus damping). scale[i] = 0 marks an unknown without information.
void scaled_hessian(const NormalEquations& equations, int n, double damping, Matrix& A, Vector& scale) {
  for (int i = 0; i < n; ++i) {
    const double diagonal = equations.hessian(i, i);
    scale[at(i)] = diagonal > 1e-9 ? 1 / std::sqrt(diagonal) : 0;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) A[at(i)][at(j)] = equations.hessian(j, i) * scale[at(i)] * scale[at(j)];
    A[at(i)][at(i)] = scale[at(i)] > 0 ? 1 + damping : 1;
  }
}

bool solve_step(const NormalEquations& equations, int n, double damping, Vector& step) {
  Matrix A;
  Vector scale{};
  scaled_hessian(equations, n, damping, A, scale);
  if (!factorize(A, n)) return false;
  for (int i = 0; i < n; ++i) step[at(i)] = equations.gradient(i) * scale[at(i)];
  substitute(A, n, step);
  for (int i = 0; i < n; ++i) step[at(i)] *= scale[at(i)];
  return true;
}

RingModel moved(const RingModel& model, const Vector& step) {
  RingModel trial = model;
  for (int i = 0; i < model.parameters(); ++i) trial[i] += step[at(i)];
  return trial;
}

double movement_px(const RingModel& model, const Vector& step) {
  double largest = 0;
  for (int i = kCentreX; i <= kLineY; ++i) largest = std::fmax(largest, std::fabs(step[at(i)]));
  return largest * model.scale_px;
}

void tally_block(const RingBlock& block, const RingPixels& pixels, int first, double mean_level, SectorTally& tally) {
  const int valid = std::min(kBlockPixels, pixels.count - first);
  for (int i = 0; i < valid; ++i) {
    const float a = std::fabs(block.direction_x[i]), b = std::fabs(block.direction_y[i]);
    const bool steep = b > a;
    const bool diagonal = (steep ? a : b) > 0.41421356F * (steep ? b : a);
    const int sector =
        (block.direction_x[i] < 0 ? 8 : 0) + (block.direction_y[i] < 0 ? 4 : 0) + (steep ? 2 : 0) + (diagonal ? 1 : 0);
    const double grey = static_cast<double>(pixels.grey[at(first + i)]);
    const double residual = static_cast<double>(block.residual[i]);
    const double deviation = grey - residual - mean_level;
    tally.misfit[at(sector)] += residual * residual;
    tally.signal[at(sector)] += deviation * deviation;
    tally.count[at(sector)] += 1;
  }
}

struct Prior {
  int parameter;
  double mean, sigma;
};

void measure_residuals(const RingModel& model, const RingPixels& pixels, std::span<float> absolute_residual) {
  RingBlock block;
  for (int first = 0; first < pixels.count; first += kBlockPixels) {
    evaluate_block(model, pixels, first, {}, block);
    const int valid = std::min(kBlockPixels, pixels.count - first);
    for (int i = 0; i < valid; ++i) absolute_residual[at(first + i)] = std::fabs(block.residual[i]);
  }
}

}  // namespace

void add_priors(const RingModel& model, double noise_grey, NormalEquations& equations) {
  // Small or slanted markers do not tell blur, ink and ring width apart, nor perspective from slant. These say what
  // every printed sheet and lens obeys; from 25 px on they are lost beside the data.
  // Where glare clips the paper, its light is known from one side only: these hold it near the sensor's range.
  const Prior priors[] = {
      {kLineX, 0, 0.5},    {kLineY, 0, 0.5}, {kInk, 0.2, 0.2}, {kBlur, 0.9 / model.scale_px, 0.5 / model.scale_px},
      {kLight0, 200, 100}, {kLightX, 0, 50}, {kLightY, 0, 50}};
  for (const Prior& prior : priors) {
    const double weight = noise_grey * noise_grey / (prior.sigma * prior.sigma);
    const double error = prior.mean - model[prior.parameter];
    equations.sum[at(prior.parameter)][at(prior.parameter)] += weight;
    equations.sum[at(prior.parameter)][kMaxParameters] += weight * error;
    equations.cost += weight * error * error;
  }
}

void evaluate(const RingModel& model, const RingPixels& pixels, const ResidualWeighting& weighting,
              std::span<float> absolute_residual, SectorTally* tally, RingEvaluation& evaluation) {
  evaluation = {};
  constexpr int kWholeTally = 16 * kBlockPixels;  // beyond, every other block tells a sector enough
  const double mean_level = model[kLight0] * (1 + model[kInk]) / 2;
  RingBlock block;
  for (int first = 0; first < pixels.count; first += kBlockPixels) {
    evaluate_block(model, pixels, first, weighting, block);
    accumulate(block, evaluation.equations);
    const int valid = std::min(kBlockPixels, pixels.count - first);
    for (int i = 0; i < valid; ++i) evaluation.outlying += block.weight[i] > 0 && block.weight[i] < 0.25F ? 1 : 0;
    if (!absolute_residual.empty()) {
      for (int i = 0; i < valid; ++i) absolute_residual[at(first + i)] = std::fabs(block.residual[i]);
    }
    const bool counts = pixels.count < kWholeTally || first / kBlockPixels % 2 == 0;
    if (tally != nullptr && counts) tally_block(block, pixels, first, mean_level, *tally);
  }
}

int fit_rings(const RingPixels& pixels, const ResidualWeighting& weighting, double noise_grey, const FitStop& stop,
              std::span<float> absolute_residual, RingModel& model) {
  RingEvaluation now, next;
  evaluate(model, pixels, weighting, absolute_residual, nullptr, now);
  add_priors(model, noise_grey, now.equations);
  double damping = 1e-3;
  int accepted = 0;
  bool measured = true;  // absolute_residual is that of `model`
  for (int iteration = 0; iteration < stop.max_iterations; ++iteration) {
    Vector step{};
    if (!solve_step(now.equations, model.parameters(), damping, step)) {
      damping = std::fmax(damping, 1e-4) * 10;
      continue;
    }
    RingModel trial = moved(model, step);
    if (!is_plausible(trial)) {
      damping *= 10;
      continue;
    }
    evaluate(trial, pixels, weighting, absolute_residual, nullptr, next);
    add_priors(trial, noise_grey, next.equations);
    measured = !(next.equations.cost > now.equations.cost);
    if (!measured) {
      damping *= 10;
      continue;
    }
    const bool settled = next.equations.cost > stop.cost_ratio * now.equations.cost;
    model = trial;
    now = next;
    damping *= 0.1;
    ++accepted;
    if (settled || movement_px(model, step) < stop.step_px) break;
  }
  if (!measured && !absolute_residual.empty()) measure_residuals(model, pixels, absolute_residual);
  return accepted;
}

double newton_step(const NormalEquations& equations, RingModel& model) {
  Vector step{};
  if (!solve_step(equations, model.parameters(), 0, step)) return -1;
  const double stretch = std::clamp(equations.weight / equations.slope, 1.0, 1.5);
  for (double& part : step) part *= stretch;
  RingModel trial = moved(model, step);
  if (!is_plausible(trial)) {
    // Rings no wider than their blur tell ink and width apart so badly that glare drives both out of all bounds along
    // that valley. It leaves the centre alone, so the centre moves and the rest stays.
    trial = model;
    for (const int i : {kCentreX, kCentreY}) trial[i] += step[at(i)];
    if (!is_plausible(trial)) return -1;
  }
  model = trial;
  return std::hypot(step[kCentreX], step[kCentreY]) * model.scale_px;
}

bool invert_equations(const NormalEquations& equations, int parameters, int first, int last, Matrix& inverse) {
  Matrix A;
  Vector scale{};
  scaled_hessian(equations, parameters, 0, A, scale);
  if (!factorize(A, parameters)) return false;
  for (int column = first; column < last; ++column) {
    Vector unit{};
    unit[at(column)] = scale[at(column)];
    substitute(A, parameters, unit, column);
    for (int row = 0; row < parameters; ++row) inverse[at(row)][at(column)] = unit[at(row)] * scale[at(row)];
  }
  return true;
}

}  // namespace roomcal::marker
