3/PROG  BEAD
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
