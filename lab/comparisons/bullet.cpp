#include "lab/comparisons/bullet.h"

#if WEFT_WITH_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include "lab/accuracy/reference.h"
#endif

namespace weft::engine::lab {

#if WEFT_WITH_BULLET
namespace {

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

class BulletContestant final : public Method {
 public:
  BulletContestant(const MethodSettings& entry, const HungCloth& cloth)
      : state_(cloth.state),
        num_substeps_(entry.steps_per_frame),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(to_bullet(cloth.environment.gravity));
    btSoftBodyWorldInfo& info = world_.getWorldInfo();
    info.m_gravity = to_bullet(cloth.environment.gravity);
    info.air_density = 0;
    world_.addSoftBody(make_body(cloth, info));
  }

  ~BulletContestant() override { world_.removeSoftBody(body_.get()); }

  void advance_frame() override {
    for (int s = 0; s < num_substeps_; ++s) world_.stepSimulation(static_cast<btScalar>(step()), 0);
  }

  const ClothState& state() override {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
      const btVector3& x = body_->m_nodes[i].m_x;
      state_.x.set(i, {x.x(), x.y(), x.z()});
    }
    return state_;
  }

 private:
  double step() const { return kReferenceFrame / num_substeps_; }

  btSoftBody* make_body(const HungCloth& cloth, btSoftBodyWorldInfo& info) {
    const ClothModel& model = *cloth.model;
    std::vector<btVector3> x;
    std::vector<btScalar> mass;
    for (int i = 0; i < model.num_particles(); ++i) {
      x.push_back(to_bullet(cloth.state.x.get(i)));
      mass.push_back(static_cast<btScalar>(model.mass[i]));
    }
    for (const int p : cloth.environment.pins.particle) mass[p] = 0;
    body_ = std::make_unique<btSoftBody>(&info, model.num_particles(), x.data(), mass.data());
    body_->m_cfg.piterations = 1;
    body_->m_cfg.collisions = 0;
    const std::vector<Spring>& springs = model.topology->springs;
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const Spring& spring = springs[s];
      const double k = model.stiffness(static_cast<int>(s));
      const double inv_mass = body_->m_nodes[spring.i].m_im + body_->m_nodes[spring.j].m_im;
      btSoftBody::Material* material = body_->appendMaterial();
      material->m_kLST = static_cast<btScalar>(inv_mass / (inv_mass + 1 / (step() * step() * k)));
      body_->appendLink(spring.i, spring.j, material);
    }
    return body_.get();
  }

  ClothState state_;
  int num_substeps_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_;
  std::unique_ptr<btSoftBody> body_;
};

}  // namespace

std::vector<MethodSettings> list_bullet_entries() {
  constexpr int kMaxParticles = 130 * 130;
  std::vector<MethodSettings> entries;
  for (const int n : {25, 50, 100, 200})
    entries.push_back({"Bullet", std::to_string(n) + " substeps", {}, n, kMaxParticles});
  return entries;
}

std::unique_ptr<Method> make_bullet_method(const MethodSettings& entry, const HungCloth& cloth) {
  return std::make_unique<BulletContestant>(entry, cloth);
}
#else
std::vector<MethodSettings> list_bullet_entries() { return {}; }

std::unique_ptr<Method> make_bullet_method(const MethodSettings&, const HungCloth&) { return nullptr; }
#endif

}  // namespace weft::engine::lab
