#pragma once
// Robot programs as their manuals write them, and what their paths are asked.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/geometry/notation.h"
#include "devices/robot_path/robot_path.h"

namespace seamwright {

inline Pose kuka(double x, double y, double z, double a = 0, double b = 0, double c = 0) {
    return make_pose(rotation_from_kuka({a, b, c}), {x, y, z});
}

inline void expect_pose(const Pose& got, const Pose& wanted, const std::string& what, double mm = 1e-9,
                        double rad = 1e-9) {
    EXPECT_LT(distance_mm(got, wanted), mm) << what << "\n" << got.matrix() << "\n" << wanted.matrix();
    EXPECT_LT(angle_rad(got, wanted), rad) << what << "\n" << got.matrix() << "\n" << wanted.matrix();
}

inline Pose in_base(const ProgramPoint& p) {
    EXPECT_TRUE(p.base_from_frame) << p.frame;
    return p.base_from_frame.value_or(Pose::Identity()) * p.frame_from_tool;
}

inline ProgramPath parsed(const std::string& name, const std::string& text,
                          const ProgramPathOptions& options = {}, std::vector<ProgramText> more = {}) {
    more.insert(more.begin(), {name, text});
    auto path = parse_program_path(more, options);
    EXPECT_TRUE(path) << path.error().sentence();
    return path ? *path : ProgramPath{};
}

inline std::string why_at(const ProgramPath& path, int line) {
    for (const ProgramLine& l : path.lines)
        if (l.line == line && l.file == path.lines.front().file)
            return std::string(to_string(l.kind)) + ": " + l.why.english();
    return "no note";
}

inline constexpr const char* kInline = R"(&ACCESS RVP
&REL 12
&PARAM TEMPLATE = C:\KRC\Roboter\Template\vorgabe
DEF BEAD( )
;FOLD INI;%{PE}
  ;FOLD BASISTECH INI
    GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )
    INTERRUPT ON 3
    BAS (#INITMOV,0 )
  ;ENDFOLD (BASISTECH INI)
;ENDFOLD (INI)
;FOLD PTP HOME  Vel= 100 % DEFAULT;%{PE}%MKUKATPBASIS
$BWDSTART = FALSE
PDAT_ACT=PDEFAULT
FDAT_ACT=FHOME
BAS (#PTP_PARAMS,100 )
$H_POS=XHOME
PTP  XHOME
;ENDFOLD
;FOLD PTP P1 CONT Vel=100 % PDAT1 Tool[1]:NOZZLE Base[2]:DOOR;%{PE}%R 8.3.40
$BWDSTART=FALSE
PDAT_ACT=PPDAT1
FDAT_ACT=FP1
BAS(#PTP_PARAMS,100)
PTP XP1 C_DIS
;ENDFOLD
;FOLD LIN P2 CONT Vel=0.2 m/s CPDAT1 Tool[1]:NOZZLE Base[2]:DOOR
$BWDSTART=FALSE
LDAT_ACT=LCPDAT1
FDAT_ACT=FP2
BAS(#CP_PARAMS,0.2)
LIN XP2 C_DIS C_DIS
;ENDFOLD
$OUT[12]=TRUE
;FOLD SLIN P3 Vel=0.2 m/s CPDAT3 Tool[1] Base[2]
SLIN XP3 WITH $VEL=SVEL_CP(0.2, , LCPDAT3), $TOOL=STOOL2(FP3), $BASE=SBASE(FP3.BASE_NO), $IPO_MODE=SIPO_MODE(FP3.IPO_FRAME), $LOAD=SLOAD(FP3.TOOL_NO)
;ENDFOLD
WAIT SEC 0.5
GUN_OFF(1)
PTP  XHOME
END
)";

inline constexpr const char* kInlineData = R"(&ACCESS RVP
DEFDAT  BEAD
;FOLD EXTERNAL DECLARATIONS;%{PE}%MKUKATPBASIS,%CEXT,%VCOMMON,%P
EXT  BAS (BAS_COMMAND  :IN,REAL  :IN )
DECL INT SUCCESS
DECL E6POS XP1={X 10.0,Y 20.0,Z 30.0,A 90.0,B 0.0,C 180.0,S 2,T 35,E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}
DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,POINT2[] " ",TQ_STATE FALSE}
DECL PDAT PPDAT1={VEL 100.000,ACC 100.000,APO_DIST 100.000,APO_MODE #CPTP}
DECL E6POS XP2={X 110.0,Y 20.0,Z 30.0,A 90.0,B 0.0,C 180.0,S 2,T 35,E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}
DECL FDAT FP2={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,POINT2[] " "}
DECL LDAT LCPDAT1={VEL 2.00000,ACC 100.000,APO_DIST 100.000,APO_FAC 50.0000,ORI_TYP #VAR}
DECL POS XP3={X 110.0,Y 120.0,Z 3.0E1,A 90.0,B 0.0,C -180.0,S 2,T 35}
DECL FDAT FP3={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,POINT2[] " "}
ENDDAT
)";

inline constexpr const char* kTp = R"(/PROG  BEAD
/ATTR
OWNER		= MNEDITOR;
PROG_SIZE	= 900;
DEFAULT_GROUP	= 1,*,*,*,*;
/APPL
/MN
   1:  !the door ;
   2:  UFRAME_NUM=2 ;
   3:  UTOOL_NUM=1 ;
   4:J P[1:home] 100% FINE    ;
   5:L P[2:start] 500mm/sec CNT50    ;
   6:  DO[3]=ON ;
   7:C P[3]    
    :  P[4] 250mm/sec CNT100    ;
   8:  PR[1,1]=5 ;
   9:  PR[1,2]=0 ;
  10:  PR[1,3]=(-2) ;
  11:  PR[1,4]=0 ;
  12:  PR[1,5]=0 ;
  13:  PR[1,6]=0 ;
  14:L P[4] 250mm/sec FINE Offset,PR[1]    ;
  15:L P[4] 250mm/sec FINE Tool_Offset,PR[1:up]    ;
  16:  FOR R[1:i]=5 TO 6 ;
  17:L P[R[1]] 20inch/min CNT0 ;
  18:  ENDFOR ;
  19:  IF DI[4]=OFF,JMP LBL[9] ;
  20:L P[2] 250mm/sec FINE ;
  21:  LBL[9] ;
  22:L P[7] 250mm/sec FINE INC ;
  23:J P[1:home] 100% FINE ;
/POS
P[1:"home"]{
   GP1:
	UF : 2, UT : 1,	
	J1=     0.000 deg,	J2=     0.000 deg,	J3=     0.000 deg,
	J4=     0.000 deg,	J5=   -90.000 deg,	J6=     0.000 deg
};
P[2:"start"]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =   100.000  mm,	Y =     0.000  mm,	Z =    10.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =    30.000 deg
};
P[3]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =     0.000  mm,	Y =   100.000  mm,	Z =    10.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =    30.000 deg
};
P[4]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  -100.000  mm,	Y =     0.000  mm,	Z =    10.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =    30.000 deg
   GP2:
	UF : 0, UT : 1,
	J1=    45.000 deg
};
P[5]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  5  mm,	Y =  5  mm,	Z = 5  mm,
	W =   0 deg,	P =  0 deg,	R =    0 deg
};
P[6]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  6  mm,	Y =  6  mm,	Z = ********  mm,
	W =   0 deg,	P =  0 deg,	R =    0 deg
};
P[7]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  1  mm,	Y =  0  mm,	Z = 0  mm,
	W =   0 deg,	P =  0 deg,	R =    0 deg
};
/END
)";

}  // namespace seamwright
