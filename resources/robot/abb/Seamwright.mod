MODULE Seamwright
    ! What measuring and application programs of T_ROB1 call; SeamwrightServer.mod shares this data. For each part:
    !   swPart:="CAR-0815";       where the line's controller knows the part
    !   swType:="left";           its type, where the project has part types and this is not SeamwrightSpots.mod's own
    !   SW_Measure;               calls for the measurement, waits for it and runs through the spots
    !   SW_Activate;              before the first path: waits for the permission and takes it, or stops
    !   MoveL p1,v100,z1,gun\WObj:=BASE_left;      the path in its work object, which was shifted
    ! SW_Activate stops the robot where a part is not released. A program that lets such a part pass asks instead:
    !   IF SW_Take() THEN         TRUE: the permission is taken and holds for this part, whatever becomes of the computer
    ! A program that waits for its parts lets somebody at the computer measure meanwhile:
    !   IF SW_Asked() THEN        to be called at least ten times a second while it waits
    !       SW_Measure\Asked;     measures without calling
    ! While spots are taught SW_Teach runs in manual mode.
    ! sw_doTrigger is the digital output that is wired to the sensors.
    PERS num swPartNo:=0;
    PERS bool swWaiting:=FALSE;
    PERS num swTick:=0;
    PERS num swCalls:=0;
    PERS string swPart:="";
    PERS bool swAsk:=FALSE;
    PERS bool swGo:=FALSE;
    PERS bool swEnded:=FALSE;
    PERS num swFired:=0;
    ! How long the robot stands after the next trigger, seconds: longer where a spot is exposed several times.
    VAR num swStand:=0.1;
    PERS pose swAt{64};
    ! The permission: for which part it is given, and whether it is gone (taken here, or taken back by the server).
    PERS num swGivenFor:=0;
    PERS bool swGone:=TRUE;
    PERS num swVerdict:=0;
    PERS bool swTeaching:=FALSE;
    PERS bool swMove:=FALSE;
    ! Counts the moves that were asked for.
    PERS num swMoveNo:=0;
    PERS pose swMoveTo:=[[0,0,0],[1,0,0,0]];
    LOCAL CONST speeddata travel:=[250,100,5000,1000];
    LOCAL CONST extjoint no_axes:=[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09];
    LOCAL VAR triggdata pulse;
    LOCAL VAR triggdata latch;
    LOCAL VAR intnum on_spot;
    LOCAL VAR num coming:=0;
    LOCAL VAR num taken_for:=0;

    PROC SW_Measure(\switch Asked)
        IF NOT swWaiting Begin_part;
        IF NOT Present(Asked) swCalls:=(swCalls MOD 8000000)+1;
        WHILE NOT swGo DO
            Tick;
            WaitTime 0.004;
            ! The call was refused as too old; the part stands here still.
            IF NOT Present(Asked) THEN
                IF swVerdict=2 THEN
                    swVerdict:=0;
                    swCalls:=(swCalls MOD 8000000)+1;
                ENDIF
            ENDIF
        ENDWHILE
        swWaiting:=FALSE;
        swGo:=FALSE;
        IDelete on_spot;
        CONNECT on_spot WITH SpotPassed;
        TriggIO pulse,0\DOp:=sw_doTrigger,1;
        TriggInt latch,0,on_spot;
        ConfL\Off;
        SW_Load;
        SW_Spots;
        ConfL\On;
        IDelete on_spot;
        swEnded:=TRUE;
    ENDPROC

    ! Does somebody at the computer want to measure? A part begins with the first question.
    FUNC bool SW_Asked()
        IF NOT swWaiting Begin_part;
        Tick;
        RETURN swGo;
    ENDFUNC

    LOCAL PROC Begin_part()
        swGo:=FALSE;
        swVerdict:=0;
        swPartNo:=(swPartNo MOD 8000000)+1;
        swWaiting:=TRUE;
    ENDPROC

    ! Tells the server that the program really waits.
    LOCAL PROC Tick()
        swTick:=(swTick MOD 1000000)+1;
    ENDPROC

    ! On the way to a spot.
    PROC SW_Via(robtarget point)
        MoveL point,travel,z5,swTool\WObj:=wobj0;
    ENDPROC

    ! One spot: straight from entry over the spot to exit, poses of the flange in the robot's base. What is told of
    ! the spot is the programmed point, over which the trigger is set off, not where the robot is when a trap runs.
    PROC SW_Pass(num number,robtarget entry,robtarget spot,robtarget leave,speeddata speed,bool standing)
        VAR num waited:=0;
        MoveL entry,travel,z5,swTool\WObj:=wobj0;
        coming:=number;
        swAt{number}.trans:=spot.trans;
        swAt{number}.rot:=spot.rot;
        IF standing THEN
            MoveL spot,speed,fine,swTool\WObj:=wobj0;
            WaitTime 0.3;
            SetDO sw_doTrigger,1;
            swFired:=number;
            WaitTime swStand;
            swStand:=0.1;
        ELSE
            TriggL spot,speed,pulse\T2:=latch,z1,swTool\WObj:=wobj0;
        ENDIF
        MoveL leave,speed,fine,swTool\WObj:=wobj0;
        SetDO sw_doTrigger,0;
        WHILE swFired<>number AND waited<0.5 DO
            WaitTime 0.01;
            waited:=waited+0.01;
        ENDWHILE
        IF swFired<>number THEN
            TPWrite "Seamwright: a spot was not passed";
            Stop;
        ENDIF
    ENDPROC

    LOCAL TRAP SpotPassed
        swFired:=coming;
    ENDTRAP

    ! TRUE: this part is released and the permission taken, which nobody takes back any more. FALSE: it was refused, the
    ! computer begins anew, or no verdict came in time (20 s unless told otherwise).
    FUNC bool SW_Take(\num MaxTime)
        VAR num most:=20;
        VAR num waited:=0;
        IF Present(MaxTime) most:=MaxTime;
        WHILE waited<=most DO
            IF taken_for=swPartNo RETURN TRUE;
            IF swGivenFor=swPartNo THEN
                ! One instruction decides between this and the server, who takes back what is not taken.
                IF TestAndSet(swGone) THEN
                    taken_for:=swPartNo;
                    RETURN TRUE;
                ENDIF
            ENDIF
            IF SW_Over() RETURN FALSE;
            WaitTime 0.01;
            waited:=waited+0.01;
        ENDWHILE
        RETURN FALSE;
    ENDFUNC

    ! The part was refused, or the computer wants to begin anew.
    FUNC bool SW_Over()
        RETURN swVerdict>1 OR swAsk;
    ENDFUNC

    ! Without permission the robot stands and says so.
    PROC SW_Activate()
        IF NOT SW_Take() THEN
            TPWrite "Seamwright has not released this part";
            Stop;
            EXIT;
        ENDIF
    ENDPROC

    ! Serves moves by command while spots are taught, until the robot is switched to automatic or somebody at the
    ! computer measures.
    PROC SW_Teach()
        VAR robtarget goal;
        VAR num number;
        swMove:=FALSE;
        swTeaching:=TRUE;
        SW_Load;
        ConfL\Off;
        WHILE OpMode()<>OP_AUTO AND (NOT swAsk) AND (NOT swGo) DO
            IF swMove THEN
                number:=swMoveNo;
                goal:=CRobT(\Tool:=swTool\WObj:=wobj0);
                goal.trans:=swMoveTo.trans;
                goal.rot:=swMoveTo.rot;
                goal.extax:=no_axes;
                MoveL goal,v100,fine,swTool\WObj:=wobj0;
                WaitTime 0.3;
                ! One that was asked for meanwhile, after this one was stopped, is driven next.
                IF number=swMoveNo swMove:=FALSE;
            ENDIF
            WaitTime 0.01;
        ENDWHILE
        ConfL\On;
        swTeaching:=FALSE;
    ENDPROC
ENDMODULE
