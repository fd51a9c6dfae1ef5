MODULE Seamwright
    ! What measuring and application programs of T_ROB1 call; SeamwrightServer.mod shares this data. For each part:
    !   swPart:="CAR-0815";       where the line's controller knows the part
    !   SW_Measure;               calls for the measurement and runs through the spots
    !   SW_Activate;              before the first path: waits for the verdict, or stops
    !   MoveL p1,v100,z1,gun\WObj:=BASE_left;      the path in its work object, which was shifted
    ! While spots are taught SW_Teach runs in manual mode.
    ! sw_doTrigger is the digital output that is wired to the sensors.
    PERS bool swCall:=FALSE;
    PERS string swPart:="";
    PERS bool swGo:=FALSE;
    PERS bool swBusy:=FALSE;
    PERS bool swEnded:=FALSE;
    PERS bool swReleased:=FALSE;
    PERS num swFired:=0;
    PERS pose swAt{64};
    PERS bool swTeaching:=FALSE;
    PERS bool swMove:=FALSE;
    PERS pose swMoveTo:=[[0,0,0],[1,0,0,0]];
    LOCAL CONST speeddata travel:=[250,100,5000,1000];
    LOCAL CONST extjoint no_axes:=[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09];
    LOCAL VAR triggdata pulse;
    LOCAL VAR triggdata latch;
    LOCAL VAR intnum on_spot;
    LOCAL VAR num next:=0;

    PROC SW_Measure()
        swReleased:=FALSE;
        swGo:=FALSE;
        swBusy:=FALSE;
        swCall:=TRUE;
        WaitUntil swGo;
        swGo:=FALSE;
        swBusy:=TRUE;
        IDelete on_spot;
        CONNECT on_spot WITH SpotPassed;
        TriggIO pulse,0\DOp:=sw_doTrigger,1;
        TriggInt latch,0,on_spot;
        ConfL\Off;
        SW_Spots;
        ConfL\On;
        IDelete on_spot;
        swBusy:=FALSE;
        swEnded:=TRUE;
    ENDPROC

    ! One spot: straight from entry over the spot to exit, poses of the flange in the robot's base.
    PROC SW_Pass(num number,robtarget entry,robtarget spot,robtarget leave,speeddata speed,bool standing)
        next:=number;
        MoveL entry,travel,z5,tool0\WObj:=wobj0;
        IF standing THEN
            MoveL spot,speed,fine,tool0\WObj:=wobj0;
            WaitTime 0.3;
            SetDO sw_doTrigger,1;
            Latch_here;
            WaitTime 0.1;
        ELSE
            TriggL spot,speed,pulse\T2:=latch,z1,tool0\WObj:=wobj0;
        ENDIF
        MoveL leave,speed,fine,tool0\WObj:=wobj0;
        SetDO sw_doTrigger,0;
        IF swFired<>number THEN
            TPWrite "Seamwright: a spot was not passed";
            Stop;
        ENDIF
    ENDPROC

    LOCAL TRAP SpotPassed
        Latch_here;
    ENDTRAP

    LOCAL PROC Latch_here()
        VAR robtarget at;
        at:=CRobT(\Tool:=tool0\WObj:=wobj0);
        swAt{next}.trans:=at.trans;
        swAt{next}.rot:=at.rot;
        swFired:=next;
    ENDPROC

    ! Without permission the robot stands and says so.
    PROC SW_Activate()
        VAR bool late;
        WaitUntil swReleased\MaxTime:=20\TimeFlag:=late;
        IF NOT swReleased THEN
            TPWrite "Seamwright has not released this part";
            Stop;
            EXIT;
        ENDIF
    ENDPROC

    ! Serves moves by command while spots are taught.
    PROC SW_Teach()
        VAR robtarget to;
        swMove:=FALSE;
        swTeaching:=TRUE;
        ConfL\Off;
        WHILE TRUE DO
            WaitUntil swMove;
            to:=CRobT(\Tool:=tool0\WObj:=wobj0);
            to.trans:=swMoveTo.trans;
            to.rot:=swMoveTo.rot;
            to.extax:=no_axes;
            MoveL to,v100,fine,tool0\WObj:=wobj0;
            WaitTime 0.3;
            swMove:=FALSE;
        ENDWHILE
    ENDPROC
ENDMODULE
