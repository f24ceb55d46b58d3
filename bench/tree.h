/* tree.h - descriptions of the systems that are stepped. Include flexbeam.h first. */
#ifndef FBB_TREE_H
#define FBB_TREE_H

/* One more body, of a model, on a node of its parent. */
static fb_joint_desc *fbb_hang(fb_system_desc *desc, int model, fb_joint_kind kind, int parent, int node)
{
  fb_joint_desc *joint = &desc->joint[desc->n_body];
  desc->model[desc->n_body++] = model;
  joint->kind = kind;
  joint->parent = parent;
  joint->parent_node = node;
  return joint;
}

static void fbb_turn(fb_joint_desc *joint, fb_real x, fb_real y, fb_real z)
{
  const fb_real phi[3] = {x, y, z};
  fb_quat_from_rotvec(joint->attitude, phi);
}

/* Number of models that its bodies have. */
static int fbb_models(const fb_system_desc *desc)
{
  int n = 0;
  for (int k = 0; k < desc->n_body; k++) {
    n = desc->model[k] >= n ? desc->model[k] + 1 : n;
  }
  return n;
}

#endif
