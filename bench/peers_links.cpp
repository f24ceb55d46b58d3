// peers_links - ten rigid links on hinges (peers_links.h) by pinocchio's articulated-body algorithm in rk4; CSV on stdout, as bench_peers_links.
// Usage: peers_links FOLDER, with links.csv of that program. Exit: 0, 1 without it.
#include "peers_links.h"
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/multibody.hpp>

using Eigen::VectorXd;

static pinocchio::Model chain()
{
  static const double inertia[3] = {LINK_INERTIA};
  const Eigen::Matrix3d J = Eigen::Vector3d(inertia[0], inertia[1], inertia[2]).asDiagonal();
  pinocchio::Model model;
  pinocchio::JointIndex last = 0;
  model.gravity.linear(Eigen::Vector3d(0, 0, LINK_GRAVITY));
  for (int k = 0; k < LINKS; k++) {
    const pinocchio::SE3 place(Eigen::Matrix3d::Identity(), Eigen::Vector3d(k ? LINK_LENGTH : 0, 0, 0));
    const std::string name = std::to_string(k);
    last = k % 2 ? model.addJoint(last, pinocchio::JointModelRZ(), place, name)
                 : model.addJoint(last, pinocchio::JointModelRY(), place, name);
    model.appendBodyToJoint(last, pinocchio::Inertia(LINK_MASS, Eigen::Vector3d(LINK_CENTER, 0, 0), J),
                            pinocchio::SE3::Identity());
  }
  return model;
}

static VectorXd run(const pinocchio::Model &model, pinocchio::Data &data, double dt)
{
  const VectorXd tau = VectorXd::Zero(LINKS);
  VectorXd q = VectorXd::Constant(LINKS, LINK_ANGLE), v = tau, x(LINKS), v2(LINKS), v3(LINKS), v4(LINKS), a1(LINKS),
           a2(LINKS), a3(LINKS);
  for (int k = (int)(LINK_END / dt + 0.5); k > 0; k--) {
    a1 = pinocchio::aba(model, data, q, v, tau);
    x = q + dt / 2 * v, v2 = v + dt / 2 * a1;
    a2 = pinocchio::aba(model, data, x, v2, tau);
    x = q + dt / 2 * v2, v3 = v + dt / 2 * a2;
    a3 = pinocchio::aba(model, data, x, v3, tau);
    x = q + dt * v3, v4 = v + dt * a3;
    const VectorXd &a4 = pinocchio::aba(model, data, x, v4, tau);
    q += dt / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return q;
}

int main(int argc, char **argv)
{
  const pinocchio::Model model = chain();
  pinocchio::Data data(model);
  VectorXd reference(LINKS), angle(LINKS);
  std::FILE *file = argc == 2 ? std::fopen((std::string(argv[1]) + "/links.csv").c_str(), "r") : nullptr;
  for (int k = 0; k < LINKS; k++) {
    if (!file || std::fscanf(file, "%lf", &reference[k]) != 1) {
      std::fprintf(stderr, "usage: peers_links FOLDER, with links.csv of bench_peers_links\n");
      return 1;
    }
  }
  for (const double dt : link_steps) {
    double least = 1e300;
    for (int k = 0; k < 5; k++) {
      const auto start = std::chrono::steady_clock::now();
      angle = run(model, data, dt);
      least =
          std::min(least, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf("links,,pinocchio,aba and rk4,%.4g,%.3e,%.4g\n", dt, (angle - reference).cwiseAbs().maxCoeff(),
                least / LINK_END);
  }
  return 0;
}
