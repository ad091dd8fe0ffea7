//! The bone names of other programs, as lists.

use super::bodies::Sample;
use super::{HORSE, MAN, expected, found};

/// Adobe Mixamo; the prefix is the program's.
const MIXAMO: &str = "
mixamorig:Hips | pelvis
  mixamorig:Spine | spine1
    mixamorig:Spine1 | spine2
      mixamorig:Spine2 | spine3
        mixamorig:Neck | neck
          mixamorig:Head | head
            mixamorig:HeadTop_End | crown
        mixamorig:LeftShoulder | clavicle_l
          mixamorig:LeftArm | upperarm_l
            mixamorig:LeftForeArm | forearm_l
              mixamorig:LeftHand | hand_l
                mixamorig:LeftHandThumb1 | thumb1_l
                  mixamorig:LeftHandThumb2 | thumb2_l
                mixamorig:LeftHandIndex1 | index1_l
                  mixamorig:LeftHandIndex2 | index2_l
                mixamorig:LeftHandMiddle1 | middle1_l
                  mixamorig:LeftHandMiddle2 | middle2_l
                mixamorig:LeftHandPinky1 | pinky1_l
                  mixamorig:LeftHandPinky2 | pinky2_l
  mixamorig:LeftUpLeg | thigh_l
    mixamorig:LeftLeg | calf_l
      mixamorig:LeftFoot | foot_l
        mixamorig:LeftToeBase | toe_l
          mixamorig:LeftToe_End | toe_end_l
";

/// Blender's Rigify, exported with the bones that deform only: limbs lose what they hang on.
const RIGIFY: &str = "
DEF-spine | pelvis
  DEF-spine.001 | spine1
    DEF-spine.002 | spine2
      DEF-spine.003 | spine3
        DEF-spine.004 | neck
          DEF-spine.005 | neck2
            DEF-spine.006 | head
DEF-pelvis.L | pelvis_l
DEF-shoulder.L | clavicle_l
DEF-upper_arm.L | upperarm_l
  DEF-upper_arm.L.001 | upperarm2_l
    DEF-forearm.L | forearm_l
      DEF-forearm.L.001 | forearm2_l
        DEF-hand.L | hand_l
DEF-thumb.01.L | thumb1_l
  DEF-thumb.02.L | thumb2_l
DEF-f_index.01.L | index1_l
  DEF-f_index.02.L | index2_l
DEF-f_middle.01.L | middle1_l
  DEF-f_middle.02.L | middle2_l
DEF-thigh.L | thigh_l
  DEF-thigh.L.001 | thigh2_l
    DEF-shin.L | calf_l
      DEF-shin.L.001 | calf2_l
        DEF-foot.L | foot_l
          DEF-toe.L | toe_l
";

/// Rigify with everything: the skin follows DEF bones; ORG and MCH bones and controls stand at the same places.
const RIGIFY_WHOLE: &str = "
root | root
  torso | pelvis bare
    MCH-spine | pelvis bare
  ORG-spine | pelvis bare
    DEF-spine | pelvis
    DEF-spine.001 | spine1
      ORG-spine.002 | spine2 bare
      DEF-spine.003 | spine3
        DEF-spine.004 | neck
          head | head bare
          DEF-spine.006 | head
        ORG-upper_arm.L | upperarm_l bare
          upper_arm_ik.L | upperarm_l bare
          DEF-upper_arm.L | upperarm_l
            DEF-upper_arm.L.001 | upperarm2_l
              ORG-forearm.L | forearm_l bare
              DEF-forearm.L | forearm_l
                hand_ik.L | hand_l bare
                DEF-hand.L | hand_l
                  ORG-f_middle.01.L | middle1_l bare
                  DEF-f_middle.01.L | middle1_l
                    DEF-f_middle.02.L | middle2_l
    ORG-thigh.L | thigh_l bare
      DEF-thigh.L | thigh_l
        shin_tweak.L | calf_l bare
        DEF-shin.L | calf_l
          foot_ik.L | ik_l bare
          DEF-foot.L | foot_l
            DEF-toe.L | toe_l
";

/// MakeHuman and MPFB, default rig: upper and lower limbs are two bones each, fingers and toes have numbers.
const MAKEHUMAN: &str = "
root | pelvis
  pelvis.L | pelvis_l
    upperleg01.L | thigh_l
      upperleg02.L | thigh2_l
        lowerleg01.L | calf_l
          lowerleg02.L | calf2_l
            foot.L | foot_l
              toe1-1.L | toe_l
              toe2-1.L | toe2_l
  spine05 | spine1
    spine03 | spine2
      spine01 | spine3
        clavicle.L | clavicle_l
          shoulder01.L | shoulder_l
            upperarm01.L | upperarm_l
              upperarm02.L | upperarm2_l
                lowerarm01.L | forearm_l
                  lowerarm02.L | forearm2_l
                    wrist.L | hand_l
                      finger1-1.L | thumb1_l
                        finger1-2.L | thumb2_l
                      metacarpal1.L | index1_l
                        finger2-1.L | index2_l
                      metacarpal2.L | middle0_l
                        finger3-1.L | middle1_l
                          finger3-2.L | middle2_l
        neck01 | neck
          neck02 | neck2
            head | head
              jaw | jaw
              eye.L | eye_l
";

/// MakeHuman's game engine rig, and Unreal's mannequin with its targets and twists.
const UNREAL: &str = "
root | root
  pelvis | pelvis
    spine_01 | spine1
      spine_02 | spine2
        spine_03 | spine3
          clavicle_l | clavicle_l
            upperarm_l | upperarm_l
              upperarm_twist_01_l | upperarm2_l
              lowerarm_l | forearm_l
                lowerarm_twist_01_l | forearm2_l
                hand_l | hand_l
                  thumb_01_l | thumb1_l
                  index_01_l | index1_l
                    index_02_l | index2_l
                  middle_metacarpal_l | middle0_l
                    middle_01_l | middle1_l
                      middle_02_l | middle2_l
          neck_01 | neck
            neck_02 | neck2
              head | head
    thigh_l | thigh_l
      thigh_twist_01_l | thigh2_l
      calf_l | calf_l
        foot_l | foot_l
          ball_l | toe_l
  ik_foot_root | root
    ik_foot_l | ik_l
";

/// VRM avatars as VRoid Studio writes them, with hair that has bones of its own.
const VROID: &str = "
Root | root
  J_Bip_C_Hips | pelvis
    J_Bip_C_Spine | spine1
      J_Bip_C_Chest | spine2
        J_Bip_C_UpperChest | spine3
          J_Bip_C_Neck | neck
            J_Bip_C_Head | head
              J_Adj_L_FaceEye | eye_l
              J_Sec_Hair1_01 | crown
          J_Bip_L_Shoulder | clavicle_l
            J_Bip_L_UpperArm | upperarm_l
              J_Bip_L_LowerArm | forearm_l
                J_Bip_L_Hand | hand_l
                  J_Bip_L_Index1 | index1_l
                  J_Bip_L_Middle1 | middle1_l
                    J_Bip_L_Middle2 | middle2_l
    J_Bip_L_UpperLeg | thigh_l
      J_Bip_L_LowerLeg | calf_l
        J_Bip_L_Foot | foot_l
          J_Bip_L_ToeBase | toe_l
";

/// The bone names of the VRM standard itself.
const VRM: &str = "
hips | pelvis
  spine | spine1
    chest | spine2
      upperChest | spine3
        neck | neck
          head | head
            leftEye | eye_l
        leftShoulder | clavicle_l
          leftUpperArm | upperarm_l
            leftLowerArm | forearm_l
              leftHand | hand_l
                leftThumbProximal | thumb1_l
                leftMiddleProximal | middle1_l
                  leftMiddleIntermediate | middle2_l
  leftUpperLeg | thigh_l
    leftLowerLeg | calf_l
      leftFoot | foot_l
        leftToes | toe_l
";

/// Autodesk's Biped: spaces, a number for the whole, fingers counted from the thumb as 0.
const BIPED: &str = "
Bip01 | root
  Bip01 Pelvis | pelvis
    Bip01 Spine | spine1
      Bip01 Spine1 | spine2
        Bip01 Neck | neck
          Bip01 Head | head
            Bip01 HeadNub | crown
          Bip01 L Clavicle | clavicle_l
            Bip01 L UpperArm | upperarm_l
              Bip01 L Forearm | forearm_l
                Bip01 L Hand | hand_l
                  Bip01 L Finger0 | thumb1_l
                    Bip01 L Finger01 | thumb2_l
                  Bip01 L Finger1 | index1_l
                    Bip01 L Finger11 | index2_l
                  Bip01 L Finger2 | middle1_l
                    Bip01 L Finger21 | middle2_l
      Bip01 L Thigh | thigh_l
        Bip01 L Calf | calf_l
          Bip01 L Foot | foot_l
            Bip01 L Toe0 | toe_l
              Bip01 L Toe0Nub | toe_end_l
";

/// Reallusion's Character Creator.
const REALLUSION: &str = "
CC_Base_BoneRoot | root
  CC_Base_Hip | pelvis
    CC_Base_Waist | spine1
      CC_Base_Spine01 | spine2
        CC_Base_Spine02 | spine3
          CC_Base_NeckTwist01 | neck
            CC_Base_NeckTwist02 | neck2
              CC_Base_Head | head
                CC_Base_L_Eye | eye_l
          CC_Base_L_Clavicle | clavicle_l
            CC_Base_L_Upperarm | upperarm_l
              CC_Base_L_UpperarmTwist01 | upperarm2_l
              CC_Base_L_Forearm | forearm_l
                CC_Base_L_ForearmTwist01 | forearm2_l
                CC_Base_L_Hand | hand_l
                  CC_Base_L_Index1 | index1_l
                  CC_Base_L_Mid1 | middle1_l
                    CC_Base_L_Mid2 | middle2_l
    CC_Base_L_Thigh | thigh_l
      CC_Base_L_ThighTwist01 | thigh2_l
      CC_Base_L_Calf | calf_l
        CC_Base_L_Foot | foot_l
          CC_Base_L_ToeBase | toe_l
";

/// Quaternius' people: no fingers, short words.
const QUATERNIUS: &str = "
Body | root
  Hips | pelvis
    Abdomen | spine1
      Torso | spine3
        Neck | neck
          Head | head
        Shoulder.L | clavicle_l
          UpperArm.L | upperarm_l
            LowerArm.L | forearm_l
              Palm.L | hand_l
    UpperLeg.L | thigh_l
      LowerLeg.L | calf_l
Foot.L | foot_l
PoleTarget.L | ik_l
";

const LEFT_RIGHT: (&str, &str) = ("Left", "Right");
const DOT: (&str, &str) = (".L", ".R");

#[test]
fn a_man_is_found_by_the_names_of_every_program() {
    for (program, lines, right, differs) in [
        ("mixamo", MIXAMO, LEFT_RIGHT, ""),
        ("rigify", RIGIFY, DOT, "abdomen: thigh_l+thigh_r"),
        (
            "rigify whole",
            RIGIFY_WHOLE,
            DOT,
            "abdomen: thigh_l+thigh_r",
        ),
        (
            "makehuman",
            MAKEHUMAN,
            DOT,
            "abdomen: thigh_l+thigh_r\nfoot_*: middle of foot_*",
        ),
        ("unreal", UNREAL, ("_l", "_r"), ""),
        ("vroid", VROID, ("_L_", "_R_"), ""),
        ("vrm", VRM, ("left", "right"), ""),
        ("3ds max", BIPED, (" L ", " R "), ""),
        ("character creator", REALLUSION, ("_L_", "_R_"), ""),
        (
            "quaternius",
            QUATERNIUS,
            DOT,
            "hand_*: middle of hand_*\nfoot_*: middle of foot_*",
        ),
    ] {
        let mut wanted = expected(MAN);
        wanted.extend(expected(differs));
        assert_eq!(found(&Sample::man(lines, right)), wanted, "{program}");
    }
}

/// As our own horse.
const OWN_HORSE: &str = "
pelvis | hips
  spine_01 | spine1
    spine_02 | spine2
      spine_03 | chest
        neck_01 | neck1
          neck_02 | neck2
            head | head
              ear_l | ear_l
        scapula_l | scapula_l
          forearm_l | forearm_l
            metacarpus_l | carpus_l
              fore_pastern_l | fpastern_l
                fore_hoof_l | fhoof_l
  tail_01 | tail1
    tail_02 | tail2
      tail_06 | tail3
        tail_07 | tail4
  thigh_l | thigh_l
    gaskin_l | stifle_l
      metatarsus_l | hock_l
        hind_pastern_l | bpastern_l
          hind_hoof_l | bhoof_l
";

/// Quaternius' animals: feet are targets outside the legs, whose clips hang them on when the rig is read.
const ANIMALS: &str = "
Body | root
  Back | hips
    Torso | spine1
      Torso2 | spine2
        Torso3 | chest
          Neck1 | neck1
            Neck2 | neck2
              Head | head
                Ear1.L | ear_l
                  Ear2.L | ear2_l
        FrontShoulder.L | scapula_l
          FrontUpperLeg.L | forearm_l
            FrontLowerLeg.L | carpus_l
    BackShoulder.L | thigh_l
      BackUpperLeg.L | stifle_l
        BackLowerLeg.L | hock_l
    Tail1 | tail1
      Tail2 | tail2
        Tail3 | tail3
          Tail4 | tail4
  PoleTargetBack.L | pole_l
IKBackLeg.L | bpastern_l
  FFB.L | bhoof_l
IKFrontLeg.L | fpastern_l
  FF.L | fhoof_l
";

/// Rigify's four-legged animals; the tail has names of its own.
const RIGIFY_ANIMAL: &str = "
DEF-spine.004 | hips
  DEF-spine.005 | spine1
    DEF-spine.006 | spine2
      DEF-spine.007 | chest
        DEF-spine.008 | neck1
          DEF-spine.009 | neck2
            DEF-spine.011 | head
              DEF-ear.L | ear_l
DEF-tail.001 | tail1
  DEF-tail.002 | tail2
    DEF-tail.003 | tail3
      DEF-tail.004 | tail4
DEF-shoulder.L | scapula_l
DEF-front_thigh.L | forearm_l
  DEF-front_shin.L | carpus_l
    DEF-front_foot.L | fpastern_l
      DEF-front_toe.L | fhoof_l
DEF-thigh.L | thigh_l
  DEF-shin.L | stifle_l
    DEF-foot.L | hock_l
      DEF-r_toe.L | bpastern_l
        DEF-r_toe.L.001 | bhoof_l
";

/// Corners of the body as two letters, numbers for the bones.
const CORNERS: &str = "
dog_root | root
  dog_pelvis | hips
    dog_spine1 | spine1
      dog_spine2 | spine2
        dog_chest | chest
          dog_neck1 | neck1
            dog_neck2 | neck2
              dog_skull | head
          dog_leg_FL_1 | scapula_l
            dog_leg_FL_2 | forearm_l
              dog_leg_FL_3 | carpus_l
                dog_leg_FL_4 | fpastern_l
                  dog_leg_FL_5 | fhoof_l
    dog_leg_BL_1 | thigh_l
      dog_leg_BL_2 | stifle_l
        dog_leg_BL_3 | hock_l
          dog_leg_BL_4 | bpastern_l
            dog_leg_BL_5 | bhoof_l
    dog_tail1 | tail1
      dog_tail2 | tail2
        dog_tail3 | tail3
          dog_tail4 | tail4
";

#[test]
fn an_animal_is_found_by_the_names_of_every_program() {
    for (program, lines, right) in [
        ("own", OWN_HORSE, ("_l", "_r")),
        ("quaternius", ANIMALS, DOT),
        ("rigify", RIGIFY_ANIMAL, DOT),
        ("corners", CORNERS, ("L_", "R_")),
    ] {
        assert_eq!(
            found(&Sample::horse(lines, right)),
            expected(HORSE),
            "{program}"
        );
    }
}
