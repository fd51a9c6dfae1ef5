2%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE Bead
  PERS wobjdata wobjDoor:=[FALSE,TRUE,"",[[1000,0,500],[0.707106781,0,0,0.707106781]],[[10,0,0],[1,0,0,0]]];
  PERS tooldata tNozzle:=[TRUE,[[0,0,200],[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];
  CONST robtarget p10:=[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pEdge{3}:=[[[100,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
    [[200,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
    [[300,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];
  CONST jointtarget jHome:=[[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num nGap:=5;
  PROC main()
    MoveAbsJ jHome,v1000,z50,tNozzle;
    rBead 2;
    MoveAbsJ jHome\NoEOffs,v1000,z50,tNozzle;
  ENDPROC
  PROC rBead(num n)
    VAR robtarget pHere;
    MoveJ Offs(p10,0,0,50),v500,z10,tNozzle\WObj:=wobjDoor;
    MoveL p10,v100,fine,tNozzle\WObj:=wobjDoor;
    SetDO doGun,1;
    FOR i FROM 1 TO Dim(pEdge,1) DO
      MoveL pEdge{i},v100,z1,tNozzle\WObj:=wobjDoor;
    ENDFOR
    MoveL RelTool(pEdge{3},0,0,-10\Rz:=90),v100,z1,tNozzle\WObj:=wobjDoor;
    pHere:=p10; pHere.trans.z:=nGap*n;
    ArcL pHere,v100,seam1,weld1,z1,tNozzle\WObj:=wobjDoor;
    PDispSet [[1,2,3],[1,0,0,0]];
    TriggL p10,v100,gunOn,z1,tNozzle\WObj:=wobjDoor;
    PDispOff;
    pHere:=CRobT(\Tool:=tNozzle\WObj:=wobjDoor);
    MoveL pHere,v100,z1,tNozzle\WObj:=wobjDoor;
    IF diReady=1 MoveL p10,v100,z1,tNozzle\WObj:=wobjDoor;
    TEST n
      CASE 1: MoveL pEdge{1},v100,z1,tNozzle\WObj:=wobjDoor;
      CASE 2,3: MoveL pEdge{2},v100,z1,tNozzle\WObj:=wobjDoor;
      DEFAULT: Stop;
    ENDTEST
  ERROR
    MoveL p10,v100,fine,tool0;
    RETRY;
  ENDPROC
ENDMODULE
