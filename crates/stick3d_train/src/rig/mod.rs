//! Skinned meshes with a skeleton: reading, writing and posing them.
